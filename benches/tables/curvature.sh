#!/bin/bash
# Does training diverge with mean curvature, and not with uniform curvature or Rayleigh quotients,
# as the paper says (section 4.4)? Fine-tunes GarNet-Local of one garment with each loss, with two
# weights (as the command has it, and 20 times that; of mean curvature that of the paper, 10) and
# three seeds, without a bound on gradients, and prints a table of the validation split.
# Stopped, it goes on where it was when it is called again.
#
#   curvature.sh FOLDER [GARMENT]
#
# VERTICES (1000), BODIES (12/3/3), POSES (12), EPOCHS (4) and RATE (2e-3) may be set, GARNET is the
# command.
set -eu
folder=$1 garment=${2:-tshirt}
garnet=${GARNET:-garnet}
mkdir -p "$folder"
cd "$folder"

[ -d "$garment" ] || "$garnet" garment "$garment" --vertices "${VERTICES:-1000}" -o "$garment" --quiet
"$garnet" dataset "$garment" -o "$garment-data" --protocol paper --bodies "${BODIES:-12/3/3}" \
  --poses "${POSES:-12}" --seed 11 --no-progress

train() {
  local name=$1 kind=$2
  [ -f "$name.done" ] && return
  cat > "$name.toml"
  rm -rf "$garment/training/$name"
  "$garnet" train "$garment" "$garment-data" --kind "$kind" --variant "$name" --config "$name.toml" \
    --no-progress > "$name.log" 2>&1 || grep -q diverged "$name.log"
  touch "$name.done"
}

head() {
  printf 'preset = "light"\nchoose_by = "loss"\nepochs = %s\nlearning_rate = %s\n%s\n' "$1" "$2" "$3"
}

train pose-space pose-space <<< '[pose_space]
rounds = 3
region_searched = 700'
{ head 6 2e-3 ''; printf '[network]\nstart = "pose-space"\n'; } | train local local

for seed in 1 2 3; do
  for row in \
    'mc-free-1 local-mc mean_curvature=5e-5;max_cotangent=1e9' \
    'mc-free-200000 local-mc mean_curvature=10.0;max_cotangent=1e9' \
    'mc-1 local-mc mean_curvature=5e-5' \
    'mc-200000 local-mc mean_curvature=10.0' \
    'umc-1 local-umc uniform_curvature=10.0' \
    'umc-20 local-umc uniform_curvature=200.0' \
    'rq-1 local-rq rayleigh=[500.0,50.0,10.0]' \
    'rq-20 local-rq rayleigh=[10000.0,1000.0,200.0]'
  do
    set -- $row
    { head "${EPOCHS:-4}" "${RATE:-2e-3}" "max_gradient = 0.0
seed = $seed"
      printf '[network]\nstart = "pose-space"\n[loss]\n%s\n' "$(tr ';' '\n' <<< "$3")"; } | train "$1-s$seed" "$2"
  done
done

# Worst and last epoch of each training, over its start.
printf '| loss | weight | seed | E_dist at the start | worst | last | L_MC last | L_RQ last | skipped |\n'
printf '|---|---|---|---|---|---|---|---|---|\n'
for log in "$garment"/training/*-s?/log.json; do
  name=$(basename "$(dirname "$log")")
  jq -r --arg name "$name" '
    ($name | capture("(?<loss>.*)-(?<weight>[0-9]+)-s(?<seed>.)")) as $n
    | [.epochs[] | .valid.distance * 1000] as $far | .epochs[-1].valid as $last
    | def r(k): . * k | round / k;
    "| \($n.loss) | \($n.weight) | \($n.seed) | \($far[0] | r(100)) | \($far | max | r(100)) | \($far[-1] | r(100)) | \($last.mean_curvature | r(10)) | \($last.rayleigh * 1e4 | r(100))e-4 | \([.epochs[].skipped] | add) |"
  ' "$log"
done
