"""answer_schema.py MODCAL SOURCE: every command's answer obeys its part of `modcal schema --answers`, a refusal, too.
Exit code 77: there is no jsonschema.
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError as error:
    print(f"{error}: answers are not checked (install python3-jsonschema)")
    sys.exit(77)

SMALL = """kind: simulate
title: small
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.1 s
simulator: {type: newmark_explicit, time_step: 4 us}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
"""
LIST = SMALL + "sweep: {product: {scene.bow.normal_force: [0.98 N, 1 N], seed: [1, 2]}}\n"


def cases(configs):
    """Words behind modcal, and the exit code, in the order in which they are run."""
    yield "run small.yaml", 0
    yield "run list.yaml --out listed", 0
    yield "run list.yaml --out parts --shard 1/2", 0
    yield "run nowhere.yaml", 3
    yield "run small.yaml --set seed=x", 3
    yield "run", 2
    yield "new calibrate record.csv --length 0.33 --out mine.yaml", 0
    yield "new simulate", 0
    yield "new nothing", 3
    yield "run mine.yaml", 0
    yield "run mine.yaml --set string.modes=58", 3
    yield "validate mine.yaml", 0
    yield "validate mine.yaml --set string.modes=5", 0
    for file in ["small.yaml", "list.yaml", "mine.yaml"]:
        yield f"plan {file}", 0
    for file in ["benchmark/optimizers", "schelleng", "paper/section7", "calibration/pluck", "structures/fit_plate",
                 "beyond/calibration_limit"]:
        yield f"plan {configs}/{file}.yaml", 0
    yield f"limit {configs}/beyond/calibrate_to_the_bound.yaml --set scene.duration=0.2", 0
    yield "list", 0
    yield "list optimizer", 0
    yield "describe optimizer nlopt", 0
    yield "schema", 0
    yield "schema --answers", 0
    yield "inspect record.csv", 0
    yield "convert record.csv other.uff", 0
    yield "reproduce fig02", 0
    yield "status listed", 0
    yield "merge listed", 0
    yield "report listed", 0
    yield "replay listed 1", 0
    yield "compare listed listed --number levels.y.std", 0
    yield "submit long.yaml --slurm --dry-run", 0
    for text in ["help run", "completion bash", "man"]:
        yield text, 0


def findings(modcal, configs, folder):
    """What the answers have that the schema has not, or the other way round."""
    def answer(words):
        done = subprocess.run([modcal, *words.split(), "--json"], cwd=folder, capture_output=True, text=True, check=False)
        return done.returncode, json.loads(done.stdout)
    schema = answer("schema --answers")[1]
    jsonschema.Draft202012Validator.check_schema(schema)
    told, told_data = set(), {}
    for words, code in cases(configs):
        command = words.split()[0]
        told.add(command)
        got, data = answer(words)
        told_data[words] = data
        if got != code:
            yield f"{words}: exit code {got}, not {code}: {data.get('error')}"
        checker = jsonschema.Draft202012Validator({"$ref": f"#/$defs/{command}", "$defs": schema["$defs"]})
        for error in checker.iter_errors(data):
            yield f"{words}: {error.json_path}: {error.message[:300]}"
    commands = {part["$ref"].split("/")[-1] for part in schema["anyOf"]}
    if commands != told:
        yield f"not tried or not in the schema: {commands ^ told}"
    yield from missing_data(told_data)


def missing_data(answers):
    """Numbers that programs need of a run."""
    run = answers["run mine.yaml"]
    f0 = next((one for one in run["parameters"] if one["name"] == "f0"), None)
    if not f0 or abs(f0["value"] - 294) > 0.1 or not 0 < f0["deviation"] < 0.1 or f0["unit"] != "Hz":
        yield f"no f0 in the answer of a calibration: {f0}"
    if not run["scores"] or run["scores"][0]["correlation"] < 0.9 or not run["verdict"]:
        yield f"no scores or no verdict: {run['scores']} {run['verdict']}"
    if answers["plan list.yaml"]["work"].get("tasks") != 4:
        yield "plan does not say how many tasks"
    if not any("modes are stated" in text for text in answers["validate mine.yaml --set string.modes=5"]["warnings"]):
        yield "too few modes are no warning"


def main():
    modcal, source = sys.argv[1], pathlib.Path(sys.argv[2])
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "small.yaml").write_text(SMALL, encoding="utf-8")
        (folder / "list.yaml").write_text(LIST, encoding="utf-8")
        # Longer than what `submit` does by itself.
        long = SMALL + f"sweep: {{product: {{seed: {list(range(1, 51))}}}}}\n"
        (folder / "long.yaml").write_text(long, encoding="utf-8")
        shutil.copy(source / "examples/bowed_violin_d.csv", folder / "record.csv")
        found = list(findings(modcal, source / "configs", folder))
    print("\n".join(found) if found else "every answer obeys the schema")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
