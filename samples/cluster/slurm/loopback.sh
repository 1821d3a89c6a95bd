#!/bin/bash
# A Slurm of two nodes on this one machine, for trying: its own munge with its own socket and key, everything under one
# directory, nothing of the system touched. Needs Debian's slurm-wlm and munge.
#
#   loopback.sh start DIR    then: export SLURM_CONF=DIR/slurm.conf; sinfo; sbatch …
#   loopback.sh stop DIR
set -euo pipefail
action=${1:?start or stop}
directory=$(mkdir -p "${2:?directory}" && cd "$2" && pwd)
conf=$directory/slurm.conf

ports() { # a free port of loopback each
  python3 -c "
import socket
sockets = [socket.socket() for _ in range($1)]
for s in sockets: s.bind(('127.0.0.1', 0))
print(*[s.getsockname()[1] for s in sockets])"
}

start() {
  mkdir -p "$directory"/{state,spool1,spool2,run}
  chmod 0700 "$directory"
  head -c 1024 /dev/urandom >"$directory/munge.key"
  chmod 0400 "$directory/munge.key"
  munged --key-file="$directory/munge.key" --socket="$directory/run/munge.socket" --pid-file="$directory/run/munged.pid" \
    --log-file="$directory/munged.log" --seed-file="$directory/munge.seed" --force
  read -r controller node1 node2 < <(ports 3)
  local cores memory
  cores=$(nproc)
  memory=$(awk '/MemTotal/ {print int($2 / 1024 / 2)}' /proc/meminfo)
  cat >"$conf" <<END
ClusterName=loopback
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$directory/run/munge.socket
CredType=cred/munge
SlurmctldPort=$controller
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
MpiDefault=none
ReturnToService=2
MaxArraySize=10000
StateSaveLocation=$directory/state
SlurmdSpoolDir=$directory/spool%n
SlurmctldPidFile=$directory/run/slurmctld.pid
SlurmdPidFile=$directory/run/slurmd_%n.pid
SlurmctldLogFile=$directory/slurmctld.log
SlurmdLogFile=$directory/slurmd_%n.log
NodeName=n1 NodeAddr=127.0.0.1 NodeHostname=localhost Port=$node1 CPUs=$cores RealMemory=$memory
NodeName=n2 NodeAddr=127.0.0.1 NodeHostname=localhost Port=$node2 CPUs=$cores RealMemory=$memory
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
END
  mkdir -p "$directory"/spooln1 "$directory"/spooln2
  export SLURM_CONF=$conf
  slurmctld -f "$conf"
  slurmd -f "$conf" -N n1
  slurmd -f "$conf" -N n2
  for _ in $(seq 50); do
    [ "$(sinfo -h -t idle -o %D 2>/dev/null)" = 2 ] && break
    sleep 0.2
  done
  sinfo
  echo "export SLURM_CONF=$conf"
}

stop() { # only what this directory's start has started
  for name in slurmd_n1 slurmd_n2 slurmctld munged; do
    [ -f "$directory/run/$name.pid" ] && kill "$(cat "$directory/run/$name.pid")" 2>/dev/null || true
  done
}

"$action"
