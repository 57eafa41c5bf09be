#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# A Slurm of its own on one machine, for tests and for trying campaigns out (root, Debian 12).
#   eval "$(deploy/slurm.sh up)"     starts controller, accounting and four virtual nodes n1..n4 and
#                                    prints the environment that the commands need
#   deploy/slurm.sh crash n2         all of node n2 dies: its daemon, its jobs
#   deploy/slurm.sh lost n2          only its daemon dies: the job runs on and nobody sees it
#   deploy/slurm.sh back n2          node n2 comes back
#   deploy/slurm.sh down             stops everything and removes its files
# Partitions: normal, low (may be preempted), high (preempts low). Everything is below
# GROUSER_SLURM_ROOT and on the loopback interface. With GROUSER_SLURM=bare there is no accounting
# and finished jobs are forgotten after two seconds; with GROUSER_SLURM=memory jobs are confined to
# their memory by cgroups (version 1).
set -euo pipefail
# shellcheck source=deploy/lib.sh
. "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

base=${GROUSER_SLURM_ROOT:-/var/tmp/grouser-slurm}
kind=${GROUSER_SLURM:-full}
user=grouser-test
port=19200
nodes=(n1 n2 n3 n4)
export SLURM_CONF=$base/slurm.conf

die() {
  echo "slurm: $*" >&2
  tail -n 5 "$base"/*.log >&2 2>/dev/null || true
  exit 1
}

# lives PROGRAM PIDFILE: the process is there and is that program; numbers are used again.
lives() {
  local pid
  pid=$(cat "$2" 2>/dev/null) && [ "$(cat "/proc/$pid/comm" 2>/dev/null)" = "$1" ]
}

# until_true SECONDS WHAT COMMAND...
until_true() {
  local end=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$end" ] || die "$what did not come up"
    sleep 0.1
  done
}

# Packages whose own daemons must not start.
install() {
  local policy=/usr/sbin/policy-rc.d made=
  if [ ! -e "$policy" ]; then
    printf '#!/bin/sh\nexit 101\n' >"$policy"
    chmod +x "$policy"
    made=yes
  fi
  need_packages slurm >&2
  [ -z "$made" ] || rm -f "$policy"
}

write_configuration() {
  local accounting memory forget=300
  accounting="AccountingStorageType=accounting_storage/slurmdbd
AccountingStorageHost=127.0.0.1
AccountingStoragePort=$((port + 1))
AccountingStoragePass=$base/munge.socket
AccountingStorageEnforce=associations,limits,qos"
  memory="ProctrackType=proctrack/linuxproc
TaskPlugin=task/none"
  if [ "$kind" = bare ]; then
    accounting="AccountingStorageType=accounting_storage/none"
    forget=2
  fi
  if [ "$kind" = memory ]; then
    memory="ProctrackType=proctrack/cgroup
TaskPlugin=task/cgroup"
    printf '%s\n' CgroupPlugin=cgroup/v1 CgroupMountpoint=/sys/fs/cgroup ConstrainRAMSpace=yes \
      ConstrainSwapSpace=yes AllowedSwapSpace=0 >"$base/cgroup.conf"
  fi
  cat >"$SLURM_CONF" <<CONF
ClusterName=grouser
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$port
SrunPortRange=$((port + 100))-$((port + 999))
AuthType=auth/munge
# A short credential: else a job that is requeued waits two minutes.
AuthInfo=socket=$base/munge.socket,cred_expire=5
StateSaveLocation=$base/state
SlurmdSpoolDir=$base/spool/%n
TmpFS=$base/tmp/%n
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
SlurmctldPidFile=$base/slurmctld.pid
SlurmdPidFile=$base/slurmd.%n.pid
SlurmctldLogFile=$base/slurmctld.log
SlurmdLogFile=$base/slurmd.%n.log
$memory
JobAcctGatherType=jobacct_gather/linux
JobAcctGatherFrequency=1
PropagateResourceLimits=NONE
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0,bf_interval=1
SlurmctldTimeout=10
SlurmdTimeout=6
MessageTimeout=5
KillWait=3
MinJobAge=$forget
CompleteWait=0
JobRequeue=1
ReturnToService=2
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
$accounting
NodeName=n[1-4] NodeHostname=$(hostname) NodeAddr=127.0.0.1 Port=$((port + 11))-$((port + 14)) CPUs=4 RealMemory=2048
PartitionName=normal Nodes=n[1-4] Default=YES MaxTime=60 DefaultTime=10 PriorityTier=10 PreemptMode=OFF DefMemPerCPU=100
PartitionName=low Nodes=n[1-4] MaxTime=60 DefaultTime=10 PriorityTier=1 PreemptMode=REQUEUE DefMemPerCPU=100
PartitionName=high Nodes=n[1-4] MaxTime=60 DefaultTime=10 PriorityTier=20 PreemptMode=OFF DefMemPerCPU=100
CONF
}

start_accounting() {
  local socket=$base/mysql.sock
  if ! lives mariadbd "$base/mysql.pid"; then
    [ -d "$base/mysql/mysql" ] ||
      mariadb-install-db --no-defaults --user=root --datadir="$base/mysql" --skip-test-db \
        --auth-root-authentication-method=normal >"$base/mysql-install.log" 2>&1 ||
      die "mariadb-install-db failed"
    setsid mariadbd --no-defaults --user=root --datadir="$base/mysql" --socket="$socket" \
      --skip-networking --pid-file="$base/mysql.pid" --innodb-buffer-pool-size=32M \
      --innodb-flush-log-at-trx-commit=0 --innodb-doublewrite=0 \
      >"$base/mysql.log" 2>&1 </dev/null &
    until_true 60 mariadb mariadb --no-defaults -uroot -S "$socket" \
      -e 'create database if not exists slurm_acct_db'
  fi
  if ! lives slurmdbd "$base/slurmdbd.pid"; then
    (umask 077 && cat >"$base/slurmdbd.conf") <<CONF
AuthType=auth/munge
AuthInfo=socket=$base/munge.socket
DbdHost=localhost
DbdAddr=127.0.0.1
DbdPort=$((port + 1))
CommunicationParameters=NoInAddrAny
SlurmUser=root
StorageType=accounting_storage/mysql
StorageHost=localhost
StorageUser=root
StorageLoc=slurm_acct_db
PidFile=$base/slurmdbd.pid
LogFile=$base/slurmdbd.log
CONF
    MYSQL_UNIX_PORT=$socket slurmdbd || die "slurmdbd does not start"
    until_true 60 slurmdbd sacctmgr -n list cluster
  fi
  [ -n "$(sacctmgr -nP list cluster grouser format=cluster)" ] || {
    sacctmgr -iQ add cluster grouser
    sacctmgr -iQ add account project Cluster=grouser
    sacctmgr -iQ add user root Account=project DefaultAccount=project
    sacctmgr -iQ add user "$user" Account=project DefaultAccount=project
  } >/dev/null
}

all_idle() {
  [ "$(sinfo -h -N -p normal -o '%N %t' | grep -cE ' (idle|mix|alloc|comp)$')" -ge "${#nodes[@]}" ]
}

up() {
  local node
  [ "$(id -u)" -eq 0 ] || die "needs root"
  install
  id "$user" >/dev/null 2>&1 || useradd --create-home --shell /bin/bash "$user"
  for node in "${nodes[@]}"; do mkdir -p "$base/spool/$node" "$base/tmp/$node"; done
  mkdir -p "$base/state"
  chmod 755 "$base"
  chmod 1777 "$base"/tmp/*
  [ -s "$SLURM_CONF" ] || write_configuration
  [ -s "$base/munge.key" ] || (umask 077 && head -c 1024 /dev/urandom >"$base/munge.key")
  lives munged "$base/munge.pid" ||
    munged --force --key-file="$base/munge.key" --socket="$base/munge.socket" \
      --pid-file="$base/munge.pid" --log-file="$base/munge.log" --seed-file="$base/munge.seed" ||
    die "munged does not start"
  [ "$kind" = bare ] || start_accounting
  lives slurmctld "$base/slurmctld.pid" || slurmctld || die "slurmctld does not start"
  until_true 30 slurmctld sh -c 'scontrol ping | grep -q UP'
  for node in "${nodes[@]}"; do
    lives slurmd "$base/slurmd.$node.pid" || slurmd -N "$node" || die "slurmd $node does not start"
  done
  until_true 60 "the nodes" all_idle
  echo "export SLURM_CONF=$SLURM_CONF"
}

# Processes of a node: jobs carry its name in their environment, step daemons its log or spool.
node_processes() {
  local entry pid
  for entry in /proc/[0-9]*; do
    pid=${entry#/proc/}
    if { tr '\0' '\n' <"$entry/environ"; } 2>/dev/null | grep -qx "SLURMD_NODENAME=$1"; then
      echo "$pid"
    elif [ "$(cat "$entry/comm" 2>/dev/null)" = slurmstepd ] &&
      find "$entry/fd" -lname "*slurmd.$1.log" -o -lname "*/spool/$1/*" 2>/dev/null | grep -q .; then
      echo "$pid"
    fi
  done
}

lose() {
  local pid
  lives slurmd "$base/slurmd.$2.pid" || die "node $2 is not up"
  kill -KILL "$(cat "$base/slurmd.$2.pid")"
  rm -f "$base/slurmd.$2.pid"
  if [ "$1" = crash ]; then
    for pid in $(node_processes "$2"); do kill -KILL "$pid" 2>/dev/null || true; done
    rm -f "$base/spool/$2"/*_*.*
  fi
  # The controller would notice in 10 to 20 s.
  scontrol update nodename="$2" state=down reason=test
}

node_is_up() { sinfo -h -n "$1" -o %t | head -n 1 | grep -qE '^(idle|mix|alloc)$'; }

back() {
  lives slurmd "$base/slurmd.$1.pid" || slurmd -N "$1" || die "slurmd $1 does not start"
  scontrol update nodename="$1" state=resume 2>/dev/null || true
  until_true 30 "node $1" node_is_up "$1"
}

# stop PROGRAM PIDFILE
stop() {
  local pid
  lives "$1" "$2" || return 0
  pid=$(cat "$2")
  kill -CONT "$pid"
  kill "$pid"
  for _ in $(seq 100); do
    kill -0 "$pid" 2>/dev/null || return 0
    sleep 0.05
  done
  kill -KILL "$pid" 2>/dev/null || true
}

down() {
  local node pid
  if lives slurmctld "$base/slurmctld.pid"; then
    timeout 5 scancel --full --signal=KILL --user=root,"$user" 2>/dev/null || true
    timeout 5 scancel --user=root,"$user" 2>/dev/null || true
  fi
  stop slurmctld "$base/slurmctld.pid"
  for node in "${nodes[@]}"; do
    stop slurmd "$base/slurmd.$node.pid"
    for pid in $(node_processes "$node"); do kill -KILL "$pid" 2>/dev/null || true; done
  done
  stop slurmdbd "$base/slurmdbd.pid"
  stop mariadbd "$base/mysql.pid"
  stop munged "$base/munge.pid"
  rm -rf -- "$base"
}

case "${1:-}" in
  up | down) "$1" ;;
  crash | lost) lose "$1" "$2" ;;
  back) back "$2" ;;
  *) sed -n '3,15s/^# \{0,1\}//p' -- "${BASH_SOURCE[0]}" >&2 && exit 2 ;;
esac
