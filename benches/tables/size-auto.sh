#!/bin/bash
# How often `--size auto` takes the size whose eases round chest, waist and hip, measured on the
# sewn garment, are nearest to those of the same garment made to measure: of bodies drawn from the
# population, against the next smaller and the next larger size. Stopped, it goes on where it was
# when it is called again.
#
#   size-auto.sh FOLDER GARMENT BODIES
#
# GARNET is the command. GARMENT is tshirt, sweater or dress.
set -eu
folder=$1 garment=$2 bodies=$3
garnet=${GARNET:-garnet}
sizes=(xs s m l xl 2xl 3xl)
mkdir -p "$folder"
cd "$folder"
[ -d bodies ] || "$garnet" body --sample "$bodies" --seed 7 -o bodies --quiet
touch "$garment.txt"

# The eases round chest, waist and hip as shares of the wearer's girths, with the options given.
eases() {
  local body=$1
  shift
  rm -rf cut
  "$garnet" garment "$garment" "$@" --body "$body" --vertices 1000 -o cut --quiet
  "$garnet" drape cut "$body" --method warp -o worn.obj --report worn.json --quiet
  jq -r '[.drapes[0].fit[] | select(.region == ("chest", "waist", "hip"))
    | "\(.region):\(.ease)"] | join(",")' worn.json
}

for body in bodies/*.obj; do
  grep -q "^$body " "$garment.txt" && continue
  rm -rf cut
  "$garnet" garment "$garment" --size auto --body "$body" --vertices 1000 -o cut --quiet
  size=$(sed -n 's/^size = "\(.*\)"/\1/p' cut/garment.toml)
  line="$body $size $(eases "$body")"
  for at in "${!sizes[@]}"; do
    [ "${sizes[at]}" = "$size" ] && place=$at
  done
  for at in $((place - 1)) $place $((place + 1)); do
    [ "$at" -lt 0 ] || [ "$at" -ge "${#sizes[@]}" ] && continue
    line="$line ${sizes[at]}=$(eases "$body" --size "${sizes[at]}")"
  done
  echo "$line" >> "$garment.txt"
done

awk '
function miss(text, wanted,    parts, pair, other, found, i, sum) {
  split(wanted, parts, ",")
  for (i in parts) { split(parts[i], pair, ":"); other[pair[1]] = pair[2] }
  split(text, found, ",")
  for (i in found) { split(found[i], pair, ":"); if (pair[1] in other) sum += (pair[2] - other[pair[1]]) ^ 2 }
  return sqrt(sum)
}
{
  best = ""; least = 9
  for (i = 4; i <= NF; i++) {
    split($i, part, "="); off = miss(part[2], $3)
    if (off < least) { least = off; best = part[1] }
    if (part[1] == $2) own = off
  }
  if (best == $2) agreed++; else { print $1, "auto:", $2, "nearest:", best; if (own - least > worst) worst = own - least }
} END { printf "%d of %d bodies (%.1f %%); elsewhere another is nearer, by %.3f of the girths at most\n", agreed, NR, 100 * agreed / NR, worst }' "$garment.txt"
