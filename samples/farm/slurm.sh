#!/usr/bin/env bash
# A sweep of weft as a Slurm job array, a part a task:
#
#   sbatch --array=1-8 samples/farm/slurm.sh FOLDER COMMAND [ARGUMENT...]
#   sbatch --array=1-8 samples/farm/slurm.sh out/sweep accuracy assets/scenes/swing.json
#
# A part whose time is up, or whose machine is wanted for something else, is put back into the queue and goes on where it was. FOLDER is one
# that all machines see; WEFT is the program, else `weft` on the path. Tasks are counted from 1, without gaps.
#SBATCH --job-name=weft
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:USR1@60
set -uo pipefail

if (( $# < 2 )) || [[ -z ${SLURM_ARRAY_TASK_ID:-} ]]; then
  echo "Usage: sbatch --array=1-N $0 FOLDER COMMAND [ARGUMENT...]" >&2
  exit 2
fi
if [[ ${SLURM_ARRAY_TASK_MIN:-} != 1 || ${SLURM_ARRAY_TASK_MAX:-} != "${SLURM_ARRAY_TASK_COUNT:-}" ]]; then
  echo "--array: parts are 1-N, not ${SLURM_ARRAY_TASK_MIN:-} to ${SLURM_ARRAY_TASK_MAX:-}" >&2
  exit 2
fi
folder=$1
shift

# Slurm signals this shell alone; the program has to hear of it, and the shell of what became of the program.
"${WEFT:-weft}" "$@" --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --out "$folder" &
program=$!
trap 'kill -USR1 "$program" 2>/dev/null' USR1
trap 'kill -TERM "$program" 2>/dev/null' TERM
wait "$program"
code=$?
while kill -0 "$program" 2>/dev/null; do   # a signal ends the first wait
  wait "$program"
  code=$?
done

# 75 asks to be put back; 128 + a signal is a program that did not listen yet.
if (( code == 75 || code == 128 + $(kill -l USR1) || code == 128 + $(kill -l TERM) )); then
  echo "Part $SLURM_ARRAY_TASK_ID of $SLURM_ARRAY_TASK_COUNT is put back"
  scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
  sleep 60   # until Slurm ends this script, so that the task never counts as failed
fi
exit "$code"
