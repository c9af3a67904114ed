#!/bin/bash
# Measures what docs/benchmarks.md tells, and prints that page. What is in FOLDER already is not
# measured again. Takes half an hour on two cores that have nothing else to do.
#
#   benchmarks.sh FOLDER > docs/benchmarks.md
#
# GARNET and LAB are the commands, PYTHON has what benches/peers/requirements.txt lists.
set -eu
mkdir -p "$1"
folder=$(cd "$1" && pwd)
cd "$(dirname "$0")/../.."
root=$PWD
garnet=$(realpath "${GARNET:-target/release/garnet}")
lab=$(realpath "${LAB:-target/release/garnet-lab}")
python=${PYTHON:-python3}
commit=$("$garnet" --version | sed -n 's/^commit //p')
report() {
  "$lab" report "$1" "$2" --commit "$commit"
}

# Lines that each program prints, the slowest first.
if [ ! -s "$folder/peers.jsonl" ]; then
  for script in "newton_vbd --substeps 10 --iterations 10" blender_cloth pytorch_network garnet_itself; do
    set -- $script
    "$python" "benches/peers/$1.py" "${@:2}" --garnet "$garnet" >> "$folder/peers.part" 2> "$folder/$1.log"
  done
  mv "$folder/peers.part" "$folder/peers.jsonl"
fi
report peers "$folder/peers.jsonl" > "$folder/peers.md"

(
  cd "$folder"
  "$garnet" dataset "$root/models/tshirt" -o data --bodies 0/0/8 --poses 8 --seed 12 --quiet
  if [ ! -s chart/chart.json ]; then
    "$garnet" chart "$root/models/tshirt" data -o chart --scenes 20 --teacher-scenes 4 \
      --quality fast,teacher --peers peers.jsonl --quiet
  fi
)
report chart "$folder/chart/chart.json" > "$folder/chart.md"

# What instruments print, as it is.
block() {
  local page=$1
  shift
  [ -s "$folder/$page.md" ] && return
  { echo '```text'; "$lab" "$@"; echo '```'; } > "$folder/$page.part"
  mv "$folder/$page.part" "$folder/$page.md"
}
block shapes check-shapes 500 all
block bmi check-shapes 300 bmi
block volumes check-poses volumes 500
block physics physics

# Lines `{{NAME}}` of the page stand for files.
awk -v folder="$folder" '
  match($0, /^\{\{.*\}\}$/) {
    file = folder "/" substr($0, 3, length($0) - 4)
    while ((getline line < file) > 0) print line
    close(file)
    next
  }
  { print }' benches/tables/benchmarks.md
