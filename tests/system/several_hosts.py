#!/usr/bin/python3
"""Ranks on several hosts, which share nothing but the folder of results: each is a network
namespace with an address, a name, a /tmp and a /dev/shm of its own, on a bridge; messages go over
TCP. The bits are those of one rank.

All of it lives in a process namespace that ends with the test, so nothing can be left behind. Where
namespaces are not permitted the test is skipped."""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import parallel_runs
import parallel_scenes

NET = "10.77.0"
HANG = 240  # [s]
TOOLS = ("ip", "unshare", "nsenter", "mount")
# Inside /mnt, a file system that ends with the namespace: the program,
# what each host gets a copy of, and the results.
PROGRAM, STAGE, SHARED, AGENT, HOSTS = (
    "/mnt/democles",
    "/mnt/stage",
    "/mnt/shared",
    "/mnt/agent",
    "/mnt/hosts",
)

LATTICE = {
    "title": "bar",
    "method": "lattice",
    "time": {"end": 1e-4, "scheme": "leapfrog"},
    "lattice": {"rotation": "small"},
    "materials": {"m": {"density": 2700, "young": 70e9, "poisson": 0.3}},
    "output": {"every": 0},
    "bodies": [
        {
            "name": "bar",
            "material": "m",
            "cell": 0.01,
            "velocity": [1, 0, 0],
            "shape": {"box": {"min": [0, 0, 0], "max": [0.3, 0.05, 0.05]}},
        }
    ],
    "boundaries": [
        {"where": {"box": {"min": [-1, -1, -1], "max": [0.005, 1, 1]}}, "fix": ["x", "y", "z"]}
    ],
}


def unshare():
    user = ["--map-root-user"] if os.getuid() else []
    return [
        "unshare",
        *user,
        "--net",
        "--mount",
        "--uts",
        "--pid",
        "--fork",
        "--kill-child",
        "--mount-proc",
    ]


def why_not():
    """Why this machine cannot run the test; None: it can."""
    missing = [tool for tool in TOOLS if not shutil.which(tool)]
    if missing:
        return f"there is no {missing[0]}"
    if not parallel_runs.mpi.is_open_mpi():
        return "mpirun is not Open MPI's"
    probe = (
        "mount -t tmpfs none /mnt && ip link add probe type bridge && "
        "ip link add one type veth peer name two && hostname probe"
    )
    try:
        run = subprocess.run(
            [*unshare(), "sh", "-c", probe], capture_output=True, text=True, timeout=60
        )
    except subprocess.TimeoutExpired:
        return "a namespace does not answer"
    return f"namespaces are not permitted: {run.stderr.strip()}" if run.returncode else None


def call(*words):
    subprocess.run(words, check=True)


def write(path, text):
    with open(path, "w") as file:
        file.write(text)
    os.chmod(path, 0o755)


def start_host(k):
    """A host that sleeps, with its own copy of the stage in its own /tmp."""
    script = (
        f"mount -t tmpfs none /tmp && mount -t tmpfs none /dev/shm && cp -r {STAGE}/. /tmp && "
        f"umount {STAGE} && hostname host{k} && "
        "echo ready && exec sleep 1000"
    )
    host = subprocess.Popen(
        ["unshare", "--net", "--mount", "--uts", "sh", "-c", script],
        stdout=subprocess.PIPE,
        text=True,
    )
    if host.stdout.readline() != "ready\n":
        sys.exit(f"host {k} does not start")
    inside = ["nsenter", "-t", str(host.pid), "--net"]
    call(
        "ip",
        "link",
        "add",
        f"port{k}",
        "type",
        "veth",
        "peer",
        "name",
        "eth0",
        "netns",
        str(host.pid),
    )
    call("ip", "link", "set", f"port{k}", "master", "bridge", "up")
    call(*inside, "ip", "link", "set", "lo", "up")
    call(*inside, "ip", "address", "add", f"{NET}.{k}/24", "dev", "eth0")
    call(*inside, "ip", "link", "set", "eth0", "up")
    write(f"{HOSTS}/{NET}.{k}", str(host.pid))


def inside(program, stage, shared, slots, args):
    """The head of the cluster, in its namespace: hosts 1, 2, ... with so many ranks each; mpirun as
    a batch system would call it. Its exit code."""
    call("hostname", "head")
    call("mount", "-t", "tmpfs", "none", "/mnt")
    for folder in (STAGE, SHARED, HOSTS):
        os.mkdir(folder)
    call("mount", "-t", "tmpfs", "none", STAGE)
    call("cp", "-r", stage + "/.", STAGE)
    call("cp", program, PROGRAM)
    call("mount", "--bind", shared, SHARED)
    call("ip", "link", "set", "lo", "up")
    call("ip", "link", "add", "bridge", "type", "bridge")
    call("ip", "address", "add", f"{NET}.100/24", "dev", "bridge")
    call("ip", "link", "set", "bridge", "up")
    write(
        AGENT,
        f'#!/bin/sh\nhost=$1\nshift\nexec nsenter -t "$(cat {HOSTS}/"$host")" --net --mount --uts '
        '--wd=/ sh -c "$*"\n',
    )  # what ssh does
    for k in range(1, len(slots) + 1):
        start_host(k)
    call("umount", STAGE)
    call("mount", "-t", "tmpfs", "none", "/tmp")
    os.chdir("/")
    env = {
        **parallel_runs.mpi.environment(),
        "TMPDIR": "/tmp",
        "HOME": "/tmp",
        "POCL_CACHE_DIR": "/tmp/kernels",
    }
    hosts = ",".join(f"{NET}.{k}:{n}" for k, n in enumerate(slots, 1))
    over_tcp = {
        "btl": "tcp,self",
        "btl_tcp_if_include": f"{NET}.0/24",
        "oob_tcp_if_include": f"{NET}.0/24",
        "plm": "rsh",
        "plm_rsh_agent": AGENT,
        "plm_rsh_no_tree_spawn": "1",
    }
    command = parallel_runs.mpi.command("--host", hosts, "-n", str(sum(slots)))
    for name, value in over_tcp.items():
        command += ["--mca", name, value]
    for name in ("TMPDIR", "HOME", "POCL_CACHE_DIR"):
        command += ["-x", name]
    command += [PROGRAM, "run", "/tmp/scene/scene.yaml", "-o", SHARED + "/out", *args]
    return subprocess.run(command, env=env, stdin=subprocess.DEVNULL).returncode


class Hosts(parallel_runs.Case):
    @classmethod
    def setUpClass(cls):
        cls.kernels = tempfile.mkdtemp(prefix="democles_kernels_")  # compiled, for all tests
        cls.addClassCleanup(shutil.rmtree, cls.kernels, True)

    def check(self, slots, content, *args):
        """The scene on one rank here, then on the hosts."""
        stage, shared = (os.path.join(self.dir, name) for name in ("stage", "shared"))
        os.makedirs(os.path.join(stage, "scene"))
        os.mkdir(shared)
        scene = parallel_scenes.write(content, os.path.join(stage, "scene"))
        alone = self.good_run(scene, 1, *args, name="alone", env={"POCL_CACHE_DIR": self.kernels})
        shutil.copytree(self.kernels, os.path.join(stage, "kernels"))  # only to save time
        command = [
            *unshare(),
            sys.executable,
            os.path.abspath(__file__),
            "--inside",
            parallel_runs.DEMOCLES,
            stage,
            shared,
            json.dumps(slots),
            json.dumps([*args, "--quiet", "--trace-from", "2", "--trace-steps", "4"]),
        ]
        done = subprocess.run(command, capture_output=True, text=True, timeout=HANG)
        self.assertEqual(done.returncode, 0, done.stderr)
        run = parallel_runs.Run(os.path.join(shared, "out"), 0, done.stderr)
        record, found = run.record(), alone.record()
        self.assertEqual(record["ranks"], sum(slots))
        self.assertEqual(record["digest"], found["digest"])
        self.assertEqual(record["energy"], found["energy"])
        self.assertEqual(run.series(), alone.series())
        self.assertEqual(len(run.frames()), len(alone.frames()))
        self.assertGreater(record["halo_bytes_per_step"], 0)
        with open(os.path.join(run.dir, "trace.json")) as file:
            names = {
                e["pid"]: e["args"]["name"]
                for e in json.load(file)["traceEvents"]
                if e["name"] == "process_name"
            }
        hosts = [k for k, n in enumerate(slots, 1) for _ in range(n)]
        for rank, host in enumerate(hosts):
            self.assertTrue(names[rank].startswith(f"rank {rank} on host{host}:"), names)

    def test_two_hosts(self):
        self.check([1, 1], parallel_scenes.ALL["few"](parallel_runs.CASES))

    def test_three_ranks(self):
        """Two on one host, which share a device and a lock there, and one on another."""
        self.check([2, 1], parallel_scenes.ALL["few"](parallel_runs.CASES))

    def test_lattice(self):
        self.check([1, 1, 1], (LATTICE, {}), "--steps", "12")


if __name__ == "__main__":
    if sys.argv[1] == "--inside":
        sys.exit(inside(*sys.argv[2:5], json.loads(sys.argv[5]), json.loads(sys.argv[6])))
    reason = why_not()
    if reason:
        print(reason)
        sys.exit(77)
    parallel_runs.main(0)
