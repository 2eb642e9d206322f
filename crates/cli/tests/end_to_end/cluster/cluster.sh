#!/usr/bin/env bash
# A Slurm cluster of one node on this machine, for tests and for trying things out.
#
#   cluster.sh start FOLDER      starts munged, slurmctld and slurmd; everything they need lies in FOLDER
#   cluster.sh kill-node FOLDER  ends the node daemon and all that it runs, as a loss of power would
#   cluster.sh start-node FOLDER starts the node daemon again
#   cluster.sh stop FOLDER       ends what start began, by process id
#
# Then `export SLURM_CONF=FOLDER/slurm.conf` and use sbatch, squeue, scancel, or `sphcut sweep --executor slurm`.
# It needs Debian's slurm-wlm and munge. Nothing outside FOLDER is touched: keys, sockets, ports and logs are its own.
# Exit code 77: this machine cannot start one (no packages, not root); the reason is on standard error.
set -euo pipefail

PATH="$PATH:/usr/sbin:/sbin"
command="${1:?start, kill-node, start-node or stop}"
mkdir -p "${2:?a folder}"
folder="$(cd "$2" && pwd -P)"

cannot() { echo "no Slurm here: $*" >&2; exit 77; }

alive() { [ -f "$folder/$1.pid" ] && kill -0 "$(cat "$folder/$1.pid")" 2> /dev/null; }

descendants() { # of a process, the deepest first
    local file child
    for file in $(grep -ls "^PPid:[[:space:]]*$1\$" /proc/[0-9]*/status); do
        child="${file#/proc/}"
        child="${child%/status}"
        descendants "$child"
        echo "$child"
    done
}

background() { # runs the rest in its own session; notes its id and what it says
    local name="$1"
    shift
    setsid "$@" > "$folder/$name.out" 2>&1 < /dev/null &
    echo $! > "$folder/$name.pid"
}

wait_for() { # seconds, what for, command
    local seconds="$1" what="$2"
    shift 2
    for _ in $(seq $((5 * seconds))); do
        "$@" > /dev/null 2>&1 && return
        sleep 0.2
    done
    tail -n 20 "$folder"/*.out "$folder"/*.log >&2 || true
    "$0" stop "$folder"
    cannot "$what does not answer after $seconds s"
}

free_port() { # one that nobody listens on
    local port
    for port in $(shuf -i 20000-29999 -n 50); do
        (: < "/dev/tcp/127.0.0.1/$port") 2> /dev/null || { echo "$port"; return; }
    done
    cannot "no free port"
}

configure() {
    local host memory
    host="$(hostname -s)"
    memory="$(awk '/^MemTotal/ { print int($2 / 1024 * 0.9) }' /proc/meminfo)"
    mkdir -p "$folder/state" "$folder/spool"
    cat > "$folder/slurm.conf" << END
ClusterName=sphcut
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.own.pid
SlurmdPidFile=$folder/slurmd.own.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
ReturnToService=2
SlurmdTimeout=10
SchedulerParameters=sched_interval=2,bf_interval=2
KillWait=10
MpiDefault=none
MailProg=/bin/true
NodeName=node NodeHostname=$host NodeAddr=127.0.0.1 CPUs=$(nproc) RealMemory=$memory
PartitionName=work Nodes=node Default=YES MaxTime=INFINITE PriorityTier=1
PartitionName=urgent Nodes=node MaxTime=INFINITE PriorityTier=2
END
}

start_node() {
    background slurmd slurmd -D -f "$folder/slurm.conf"
    wait_for 30 slurmd sh -c 'sinfo --noheader --format=%t | grep -qE "idle|mix|alloc|comp"'
}

stop_one() { # name: ends it and what it runs
    alive "$1" || { rm -f "$folder/$1.pid"; return 0; }
    local id
    id="$(cat "$folder/$1.pid")"
    kill "$id" 2> /dev/null || true
    for _ in $(seq 25); do kill -0 "$id" 2> /dev/null || break; sleep 0.2; done
    kill -9 "$id" 2> /dev/null || true
    rm -f "$folder/$1.pid"
}

# Step daemons leave the family of slurmd: they are known by the folder in their environment.
steps() {
    local file
    for file in $(grep -lsa '^slurmstepd' /proc/[0-9]*/cmdline); do
        file="${file%/cmdline}"
        if grep -qsaz "^SLURM_CONF=$folder/slurm.conf\$" "$file/environ"; then
            echo "${file#/proc/}"
        fi
    done
}

kill_node() {
    local id step
    id="$(cat "$folder/slurmd.pid")"
    for step in $(steps); do
        # shellcheck disable=SC2046 # one word for every process
        kill -9 "$step" $(descendants "$step") 2> /dev/null || true
    done
    kill -9 "$id" 2> /dev/null || true
    rm -f "$folder/slurmd.pid"
}

export SLURM_CONF="$folder/slurm.conf"
case "$command" in
    start)
        for program in munged slurmctld slurmd sbatch; do
            command -v "$program" > /dev/null || cannot "no $program (Debian: apt-get install slurm-wlm munge)"
        done
        alive slurmctld && { echo "a cluster runs in $folder already" >&2; exit 1; }
        configure
        (umask 077 && head -c 128 /dev/urandom > "$folder/munge.key")
        background munged munged --foreground --force --num-threads=2 --key-file="$folder/munge.key" \
            --socket="$folder/munge.socket" --log-file="$folder/munged.log" \
            --pid-file="$folder/munged.own.pid" --seed-file="$folder/munged.seed"
        wait_for 10 munged test -S "$folder/munge.socket"
        background slurmctld slurmctld -D -f "$folder/slurm.conf"
        wait_for 20 slurmctld scontrol ping
        start_node
        echo "export SLURM_CONF=$folder/slurm.conf"
        ;;
    start-node) start_node ;;
    kill-node) kill_node ;;
    stop)
        [ -f "$folder/slurmd.pid" ] && kill_node
        stop_one slurmctld
        stop_one munged
        ;;
    *) echo "start, kill-node, start-node or stop, not $command" >&2; exit 2 ;;
esac
