#!/bin/bash
#SBATCH --job-name=gabc123def456
#SBATCH --ntasks=10
#SBATCH --nodes=3
#SBATCH --time=0-08:00:00
#SBATCH --signal=B:USR1@300
#SBATCH --mem=64G
#SBATCH --partition=batch
#SBATCH --account=soil@gpu
#SBATCH --qos=normal
#SBATCH --exclude=node7,node12
#SBATCH --no-requeue
#SBATCH --array=0-1%1
#SBATCH --output=/dev/null
# Several runs of campaign sweep; written by grouser.
scripts=(
  '/scratch/it'\''s here/a.sh'
  '/scratch/b.sh'
)
exec bash "${scripts[$SLURM_ARRAY_TASK_ID]}"
