# A benchmark suite as jobs of Snakemake, on this machine or on a cluster by a profile:
#
#   snakemake --snakefile apps/fleet/benchmark.smk --config suite=simulated out=results --cores 8 --keep-going
#
# Also: data=FOLDER of recordings, groundloop=COMMAND, threads=N of a step. When all steps are done `groundloop benchmark`
# makes the tables; it runs nothing again.

import json
import subprocess

suite, out = config["suite"], config["out"]
threads_of_step = config.get("threads", 2)
benchmark = f"{config.get('groundloop', 'groundloop')} --threads {threads_of_step} benchmark '{suite}' --out '{out}'"
if "data" in config:
    benchmark += f" --data '{config['data']}'"
listed = subprocess.run(f"{benchmark} --steps", shell=True, check=True, capture_output=True, text=True)
steps = {step["name"]: step for step in json.loads(listed.stdout)["steps"]}


wildcard_constraints:
    step=".+",


rule all:
    input:
        expand(f"{out}/steps/{{step}}.done", step=steps),
    shell:
        "{benchmark}"


rule step:
    input:
        lambda w: [f"{out}/steps/{need}.done" for need in steps[w.step]["needs"]],
    output:
        touch(f"{out}/steps/{{step}}.done"),
    threads: threads_of_step
    resources:
        mem_mb=lambda w: steps[w.step]["memory_mb"],
    log:
        f"{out}/steps/{{step}}.snakemake.log",
    shell:
        "{benchmark} --step {wildcards.step:q} 2> {log:q}"
