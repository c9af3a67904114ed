#!/bin/bash
# How often drapes by `--budget B` keep within 1.1 B: of poses of the library, in runs of their own,
# on a machine that does nothing else. A budget that the quickest variant cannot keep is left out.
#
#   budget.sh PACKAGE MILLISECONDS...
#
# GARNET is the command, EVERY (3) takes one pose of so many.
set -eu
package=$1
shift
garnet=${GARNET:-garnet}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
poses=$("$garnet" poses --json | jq -r '.[].name' | awk -v every="${EVERY:-3}" 'NR % every == 1 || every == 1')
for budget in "$@"; do
  for pose in $poses; do
    "$garnet" drape "$package" --pose "$pose" --budget "$budget" -o "$folder/drape.obj" \
      --report "$folder/report.json" --quiet 2> "$folder/told" || true
    jq -r --arg budget "$budget" 'select(.choice.is_met)
      | [$budget, .choice.chosen, (.drapes[0].seconds | 1e3 * (.fit + .warp + .network + .settle + .untangle)),
         1e3 * (.choice.chosen as $chosen | .choice.settles as $settles | .choice.candidates[]
           | select(.variant == $chosen and .settles == $settles) | .seconds)]
      | @tsv' "$folder/report.json"
  done
done | awk -F '\t' '
{ key = sprintf("%5d ms %-9s", $1, $2); all[key]++; kept[key] += $3 <= 1.1 * $1; sum += $3 <= 1.1 * $1; said[key] += $4; took[key] += $3 }
END {
  for (key in all)
    printf "%s %3d of %3d within, %.0f ms in the mean, %.0f expected\n", key, kept[key], all[key], took[key] / all[key], said[key] / all[key] | "sort"
  close("sort")
  printf "%d of %d (%.1f %%)\n", sum, NR, 100 * sum / NR
}'
