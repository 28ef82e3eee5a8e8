#!/bin/sh
# sbatch slurm.sh SCENE [OPTION ...]      all parts; the same command goes on with what is unfinished
# sbatch --array=3,5 slurm.sh SCENE ...   some parts only, still of 8
#SBATCH --job-name=sweep
#SBATCH --array=1-8
#SBATCH --cpus-per-task=4
#SBATCH --time=04:00:00
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --signal=B:TERM@60
parts=8
exec tangency sweep "$@" --part "$SLURM_ARRAY_TASK_ID/$parts" --threads "$SLURM_CPUS_PER_TASK"
