#!/bin/bash
# The paper's protocol on one garment: all bodies are in the same poses. Makes the data, trains the
# paper's networks and writes a report for `garnet-lab report paper`. Stopped, it goes on where it
# was when it is called again.
#
#   seen-poses.sh FOLDER GARMENT TRAIN/VALID/TEST POSES VARIANT...
#
# VERTICES (1500) and EPOCHS (6; half of them where a variant is fine-tuned) may be set, GARNET is
# the command. Variants: those of `garnet train --kind`, and what tables 5 and 6 leave out of the
# loss: only-pen, no-normal, no-pen, no-bend, rq-8, rq-16, rq-32, rq-8-16.
set -eu
folder=$1 garment=$2 bodies=$3 poses=$4
shift 4
garnet=${GARNET:-garnet}
mkdir -p "$folder"
cd "$folder"

[ -d "$garment" ] || "$garnet" garment "$garment" --vertices "${VERTICES:-1500}" -o "$garment" --quiet
"$garnet" dataset "$garment" -o "$garment-data" --protocol paper --bodies "$bodies" --poses "$poses" --seed 11 --no-progress

# A configuration: the start, the precision, and what a variant has of its own.
config() {
  printf 'preset = "light"\nchoose_by = "loss"\nprecision = "f16"\n%s\n[network]\nstart = "pose-space"\n%s\n' "$1" "$2"
}

train() {
  local name=$1 kind=$2 epochs=$3 loss=$4
  [ -f "$garment/$name.done" ] && return
  local rate=2e-3
  [ "$epochs" = "$tuned" ] && rate=3e-4
  config "epochs = $epochs
learning_rate = $rate" "$loss" > "$garment-$name.toml"
  # What was stopped goes on with the kind and configuration it began with.
  local how=(--kind "$kind" --config "$garment-$name.toml")
  [ -f "$garment/training/$name/state.safetensors" ] && how=(--resume)
  "$garnet" train "$garment" "$garment-data" --variant "$name" "${how[@]}" \
    --no-progress >> "$garment-$name.log" 2>&1
  touch "$garment/$name.done"
  tail -4 "$garment-$name.log"
}

epochs=${EPOCHS:-6}
tuned=$((epochs / 2))
if [ ! -f "$garment/pose-space.done" ]; then
  printf 'precision = "f16"\n[pose_space]\nrounds = 3\nregion_searched = 700\n' > "$garment-pose-space.toml"
  "$garnet" train "$garment" "$garment-data" --kind pose-space --config "$garment-pose-space.toml" \
    --no-progress > "$garment-pose-space.log" 2>&1
  touch "$garment/pose-space.done"
  tail -4 "$garment-pose-space.log"
fi
for variant in "$@"; do
  case $variant in
    only-pen) train $variant local $epochs '[loss]
normal = 0.0
bending = 0.0' ;;
    no-normal) train $variant local $epochs '[loss]
normal = 0.0' ;;
    no-pen) train $variant local $epochs '[loss]
penetration = 0.0' ;;
    no-bend) train $variant local $epochs '[loss]
bending = 0.0' ;;
    rq-8) train $variant local-rq $tuned '[loss]
rayleigh = [500.0, 0.0, 0.0]' ;;
    rq-16) train $variant local-rq $tuned '[loss]
rayleigh = [0.0, 50.0, 0.0]' ;;
    rq-32) train $variant local-rq $tuned '[loss]
rayleigh = [0.0, 0.0, 10.0]' ;;
    rq-8-16) train $variant local-rq $tuned '[loss]
rayleigh = [500.0, 50.0, 0.0]' ;;
    local-rq) train $variant $variant $tuned '[loss]
rayleigh = [500.0, 50.0, 10.0]' ;;
    local-mc) train $variant $variant $tuned '[loss]
mean_curvature = 5e-5' ;;
    local-mcrq) train $variant $variant $tuned '[loss]
mean_curvature = 5e-5
rayleigh = [500.0, 50.0, 10.0]' ;;
    local-umc) train $variant $variant $tuned '[loss]
uniform_curvature = 10.0' ;;
    *) train "$variant" "$variant" $epochs '' ;;
  esac
done
"$garnet" eval "$garment" "$garment-data" --settle 0 --report "seen-$garment.json" --no-progress
