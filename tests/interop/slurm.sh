#!/usr/bin/env bash
# Slurm on one node: samples/farm/slurm.sh with a sweep in eight parts. One is asked to stop, and puts itself back; one is killed, and put
# back. slurm.sh WEFT FOLDER, as root. munged, slurmctld and slurmd are started here, apart from any that run, and ended.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
weft=$1 folder=$2
# shellcheck source=tests/interop/sweep.sh
source "$root/tests/interop/sweep.sh"
(( EUID == 0 )) || fail "slurmd has to be started by root"

daemons=()
end_daemons() {
  local tries
  timeout 10 scancel --quiet --user root 2>/dev/null || true
  for (( tries = 0; tries < 20; tries++ )); do   # a step that outlives slurmd is nobody's
    [[ -n $(timeout 5 squeue --noheader 2>/dev/null) ]] || break
    sleep 0.5
  done
  (( ${#daemons[@]} == 0 )) && return
  kill "${daemons[@]}" 2>/dev/null || true
  sleep 2   # slurmctld saves its state
  kill -KILL "${daemons[@]}" 2>/dev/null || true
}
trap end_daemons EXIT

host=$(hostname -s)
export SLURM_CONF=$folder/slurm.conf
mkdir -p "$folder"/{state,spool}
chmod 755 "$folder"   # munged wants to see who may write above its socket
port=$(( 20000 + $$ % 20000 ))
cat > "$SLURM_CONF" <<END
ClusterName=weft
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$(( port + 1 ))
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket,cred_expire=5
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_min_interval=100000
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
MinJobAge=3600
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=60 State=UP
END
head -c 128 /dev/urandom > "$folder/munge.key"
chmod 600 "$folder/munge.key"
munged --foreground --force --socket="$folder/munge.socket" --key-file="$folder/munge.key" --pid-file="$folder/munge.pid" \
  --log-file="$folder/munge.log" --seed-file="$folder/munge.seed" > /dev/null 2>&1 &
daemons+=($!)
slurmctld -D > /dev/null 2>&1 &
daemons+=($!)
slurmd -D > /dev/null 2>&1 &
daemons+=($!)
idle() { [[ $(timeout 5 sinfo --noheader --format=%T 2>/dev/null) == idle ]]; }
within 60 idle

cd "$folder"
job=$(WEFT=$recorded timeout 30 sbatch --parsable --array="1-$parts" --output="$folder/part-%a.log" \
  "$root/samples/farm/slurm.sh" "$folder/farm" "${sweep[@]}")
state_is() { [[ $(timeout 5 scontrol --oneliner show job "${job}_$1" 2>/dev/null) == *"JobState=$2 "* ]]; }

within 60 part_has_rows 1
timeout 30 scancel --batch --signal=USR1 "${job}_1"   # as --signal=B:USR1@60 does when the time is nearly up
within 60 part_has_rows 8
stop_part KILL 8
within 60 state_is 8 FAILED
timeout 30 scontrol requeue "${job}_8"

done_all() {
  local k
  for (( k = 1; k <= parts; k++ )); do state_is "$k" COMPLETED || return; done
}
within 300 done_all
grep -q 'Stopped by SIGUSR1 after' part-1.log || fail "part 1 was not stopped"
for k in 1 8; do grep -q 'Going on: ' "part-$k.log" || fail "part $k did not go on"; done
if ! timeout 60 "$weft" merge farm/accuracy.*-of-"$parts".rows --out "$folder/farm" > merge.log 2>&1; then
  cat merge.log >&2
  fail "weft merge failed"
fi
expect_same "$folder/farm"
echo "passed: a sweep in $parts parts by slurmctld and slurmd, one of them stopped, one killed and put back"
