#!/bin/bash
# Table 4: T-shirts of different cuts on bodies in one pose, networks that are told the sewing
# parameters. Stopped, it goes on where it was when it is called again.
#
#   sewing.sh FOLDER
#
# BODIES (380/4/20) and EPOCHS (12) may be set; GARNET and LAB are the commands.
set -eu
garnet=${GARNET:-garnet} lab=${LAB:-garnet-lab}
mkdir -p "$1"
cd "$1"
[ -d tshirt ] || "$garnet" garment tshirt --vertices 1500 -o tshirt --quiet
"$garnet" dataset tshirt -o data --protocol paper --bodies "${BODIES:-380/4/20}" --poses 1 --seed 12 \
  --vary chest-ease=10:35 --vary length=56:76 --vary sleeve=16:34 --no-progress
printf 'preset = "light"\nepochs = %s\nlearning_rate = 2e-3\nprecision = "f16"\nsewing_parameters = true\n' \
  "${EPOCHS:-12}" > config.toml
for variant in local global; do
  [ -f "tshirt/$variant.done" ] && continue
  resume=
  [ -d "tshirt/training/$variant" ] && resume=--resume
  "$garnet" train tshirt data --variant $variant --config config.toml --no-progress $resume > $variant.log 2>&1
  touch "tshirt/$variant.done"
  tail -4 $variant.log
done
"$lab" sewing tshirt data local global --report sewing.json
