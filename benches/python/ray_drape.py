"""Drapes the parts of a job on the workers of a Ray cluster.

    pip install ray
    python ray_drape.py PARTS COMMAND...

`COMMAND` is one of garnet without `--shard`; its output is a folder that all workers see. With no
cluster at hand, Ray starts one on this machine. `--workers N` before PARTS limits that to N.

    python ray_drape.py 4 garnet drape shirt --pose walk.bvh:0:240 -o frames
"""

import subprocess
import sys

import ray


@ray.remote(num_cpus=1, max_retries=2)
def part(number, parts, command):
    command = [*command, "--shard", f"{number}/{parts}", "--threads", "1", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    return number, done.returncode, done.stderr


def main():
    arguments = sys.argv[1:]
    workers = None
    if arguments[0] == "--workers":
        workers, arguments = int(arguments[1]), arguments[2:]
    parts, command = int(arguments[0]), arguments[1:]
    ray.init(num_cpus=workers, log_to_driver=False, include_dashboard=False)
    waiting = [part.remote(number, parts, command) for number in range(1, parts + 1)]
    failed = 0
    for number, status, told in ray.get(waiting):
        print(f"part {number} of {parts}: {'done' if status == 0 else f'status {status}'}")
        if status != 0:
            print(told, file=sys.stderr)
            failed += 1
    sys.exit(1 if failed else 0)


main()
