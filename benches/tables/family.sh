#!/bin/bash
# Bodies of another family in one pose: drapes by the variants of packages beside the simulator's.
#
#   family.sh FOLDER RIGS POSE PACKAGE VARIANT...
#
# RIGS is a folder of `*.rig.npz`. Writes `FOLDER/GARMENT.json` for `garnet-lab report paper`. GARNET
# and LAB are the commands.
set -eu
folder=$1 rigs=$2 pose=$3 package=$4
shift 4
garnet=${GARNET:-garnet} lab=${LAB:-garnet-lab}
name=$(basename "$package")
drapes=$folder/$name
mkdir -p "$drapes"
for rig in "$rigs"/*.rig.npz; do
  body=$(basename "$rig" .rig.npz)
  scene=$drapes/$body
  on="--rest-body $rig --rig $rig --pose $pose --quiet"
  "$garnet" simulate "$package" $on -o "$scene.simulated.obj" || continue
  "$garnet" drape "$package" $on --method warp -o "$scene.warp.obj" --body-out "$scene.body.obj"
  for variant in "$@"; do
    "$garnet" drape "$package" $on --method "$variant" -o "$scene.$variant.obj"
  done
done
"$lab" compare "$drapes" --garment "$name" --report "$folder/$name.json"
