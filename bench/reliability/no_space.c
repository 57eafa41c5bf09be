/* SPDX-License-Identifier: BSD-3-Clause
 * For LD_PRELOAD: the NO_SPACE_AT-th call that needs room below NO_SPACE_BELOW fails with ENOSPC,
 * and so does every later one. NO_SPACE_COUNT names a file in which the number of calls is left.
 * Only in the program that NO_SPACE_IN names, not in what it starts. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static long calls;

static int is_meant(void) {
  const char* name = getenv("NO_SPACE_IN");
  return name != NULL && strcmp(program_invocation_short_name, name) == 0;
}

static int below(const char* path) {
  const char* folder = getenv("NO_SPACE_BELOW");
  return folder != NULL && strncmp(path, folder, strlen(folder)) == 0;
}

static int fails(void) {
  if (!is_meant()) return 0;
  const char* at = getenv("NO_SPACE_AT");
  ++calls;
  return at != NULL && calls >= atol(at);
}

static int is_ours(int file) {
  char link[64], path[PATH_MAX];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return 0;
  path[length] = '\0';
  return below(path);
}

#define REAL(name) \
  static __typeof__(name)* real; \
  if (real == NULL) real = (__typeof__(name)*)dlsym(RTLD_NEXT, #name)
#define REFUSE(condition, value) \
  if ((condition) && fails()) { \
    errno = ENOSPC; \
    return value; \
  }

ssize_t write(int file, const void* data, size_t size) {
  REAL(write);
  REFUSE(is_ours(file), -1)
  return real(file, data, size);
}
ssize_t pwrite(int file, const void* data, size_t size, off_t at) {
  REAL(pwrite);
  REFUSE(is_ours(file), -1)
  return real(file, data, size, at);
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t at) {
  REAL(pwrite64);
  REFUSE(is_ours(file), -1)
  return real(file, data, size, at);
}
ssize_t pwritev(int file, const struct iovec* parts, int count, off_t at) {
  REAL(pwritev);
  REFUSE(is_ours(file), -1)
  return real(file, parts, count, at);
}
int posix_fallocate(int file, off_t at, off_t size) {
  REAL(posix_fallocate);
  if (is_ours(file) && fails()) return ENOSPC;
  return real(file, at, size);
}
int posix_fallocate64(int file, off64_t at, off64_t size) {
  REAL(posix_fallocate64);
  if (is_ours(file) && fails()) return ENOSPC;
  return real(file, at, size);
}
int fallocate(int file, int mode, off_t at, off_t size) {
  REAL(fallocate);
  REFUSE(is_ours(file), -1)
  return real(file, mode, at, size);
}
int fsync(int file) {
  REAL(fsync);
  REFUSE(is_ours(file), -1)
  return real(file);
}
int fdatasync(int file) {
  REAL(fdatasync);
  REFUSE(is_ours(file), -1)
  return real(file);
}
int mkdir(const char* path, mode_t mode) {
  REAL(mkdir);
  REFUSE(below(path), -1)
  return real(path, mode);
}
int rename(const char* from, const char* to) {
  REAL(rename);
  REFUSE(below(to), -1)
  return real(from, to);
}

static void __attribute__((destructor)) leave_count(void) {
  const char* name = getenv("NO_SPACE_COUNT");
  if (name == NULL || !is_meant()) return;
  FILE* out = fopen(name, "w");
  if (out == NULL) return;
  fprintf(out, "%ld\n", calls);
  fclose(out);
}
