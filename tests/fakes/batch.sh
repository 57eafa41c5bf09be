# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash
# Shared by the stand-ins for batch systems. FAKE_BATCH_DIR holds one directory per job
# (name, pid, exit, cancelled) and, for each command, a file COMMAND.modes: every call takes its
# first line off and misbehaves as it says.

mkdir -p "$FAKE_BATCH_DIR/jobs"

# next_mode COMMAND: takes the first line of its modes off and prints it.
next_mode() {
  local file="$FAKE_BATCH_DIR/$1.modes"
  [ -s "$file" ] || return 0
  head -n 1 "$file"
  tail -n +2 "$file" >"$file.tmp"
  mv "$file.tmp" "$file"
}

count_call() {
  echo x >>"$FAKE_BATCH_DIR/$1.calls"
}

# start_job NAME DIRECTORY LOG SCRIPT ID-VARIABLE SUFFIX: prints the new job's id.
start_job() {
  local id=1000
  while ! mkdir "$FAKE_BATCH_DIR/jobs/$id" 2>/dev/null; do id=$((id + 1)); done
  local job="$FAKE_BATCH_DIR/jobs/$id"
  echo "$1" >"$job/name"
  cp "$4" "$job/script"
  (
    cd "$2" || exit 1
    export "$5=$id$6"
    setsid bash -c 'echo $$ >"$1/pid"; bash "$1/script" >>"$2" 2>&1; echo $? >"$1/exit"' _ \
      "$job" "$3" </dev/null >/dev/null 2>&1 &
  )
  echo "$id"
}

# phase JOB-DIRECTORY: RUNNING, COMPLETED, FAILED or CANCELLED.
phase() {
  if [ -e "$1/exit" ]; then
    if [ -e "$1/cancelled" ]; then
      echo CANCELLED
    elif [ "$(cat "$1/exit")" = 0 ]; then
      echo COMPLETED
    else
      echo FAILED
    fi
  elif [ -e "$1/pid" ] && ! kill -0 "$(cat "$1/pid")" 2>/dev/null; then
    [ -e "$1/cancelled" ] && echo CANCELLED || echo NODE_FAIL
  else
    echo RUNNING
  fi
}

# end_job JOB-DIRECTORY SIGNAL
end_job() {
  [ -e "$1/pid" ] || return 0
  echo x >"$1/cancelled"
  pkill "-$2" --session "$(cat "$1/pid")"
}
