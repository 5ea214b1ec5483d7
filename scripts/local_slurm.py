"""Slurm's daemons on this machine, which is the controller and the only node, with a configuration of their own."""
import os
import pathlib
import shutil
import socket
import subprocess
import time

DAEMONS = ("munged", "slurmctld", "slurmd", "sbatch")
PATH = os.environ["PATH"] + ":/usr/sbin:/sbin"


def lacking():
    """Why Slurm cannot run here, or None."""
    absent = [name for name in DAEMONS if not shutil.which(name, path=PATH)]
    if absent:
        return f"no {absent[0]}: install slurm-wlm"
    return "slurmd runs as root" if os.geteuid() else None


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class LocalSlurm:
    """The daemons run from `start_all` to `stop`. Jobs find `program` as `underbrush`, and work in `folder`. `workers`
    tasks run at once; by default, as many as there are processors."""

    def __init__(self, folder, program, workers=None):
        self.folder = pathlib.Path(folder).resolve()
        self.state = self.folder / "slurm"
        self.state.mkdir(mode=0o755)
        self.folder.chmod(0o755)
        bin_folder = self.folder / "bin"
        bin_folder.mkdir()
        (bin_folder / "underbrush").symlink_to(pathlib.Path(program).resolve())
        self.environment = dict(os.environ, PATH=f"{bin_folder}:{PATH}", SLURM_CONF=str(self.state / "slurm.conf"))
        self.daemons = []
        host = socket.gethostname().partition(".")[0]
        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") >> 20
        (self.state / "key").write_bytes(os.urandom(1024))
        (self.state / "key").chmod(0o400)
        (self.state / "slurm.conf").write_text(f"""ClusterName=underbrush
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={free_port()}
SlurmdPort={free_port()}
SlurmUser=root
AuthType=auth/munge
AuthInfo=socket={self.state}/munge
StateSaveLocation={self.state}/state
SlurmdSpoolDir={self.state}/spool
SlurmctldPidFile={self.state}/slurmctld.pid
SlurmdPidFile={self.state}/slurmd.pid
SlurmctldLogFile={self.state}/slurmctld.log
SlurmdLogFile={self.state}/slurmd.log
SlurmdParameters=config_overrides
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=0
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
NodeName={host} NodeAddr=127.0.0.1 CPUs={workers or os.cpu_count()} RealMemory={memory} State=UNKNOWN
PartitionName=all Nodes={host} Default=YES State=UP
""")

    def start_all(self):
        self.start("munged", "--foreground", "--force", f"--socket={self.state}/munge", f"--key-file={self.state}/key",
                   f"--pid-file={self.state}/munged.pid", f"--log-file={self.state}/munged.log",
                   f"--seed-file={self.state}/seed")
        self.wait_for(lambda: (self.state / "munge").exists())
        self.start("slurmctld", "-D", "-i")
        node = self.start("slurmd", "-D")
        self.wait_for(lambda: "idle" in self.say("sinfo", "--noheader", "--format=%t"))
        return node

    def start(self, *words):
        daemon = subprocess.Popen(words, env=self.environment, cwd=self.folder, stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL)
        self.daemons.append(daemon)
        return daemon

    def stop(self):
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait()

    def say(self, *words):
        return subprocess.run(words, env=self.environment, cwd=self.folder, capture_output=True, text=True, check=False).stdout

    def wait_for(self, done, seconds=60):
        """Raises `TimeoutError` with the queue and the ends of the daemons' logs."""
        end = time.monotonic() + seconds
        while not done():
            if time.monotonic() > end:
                logs = "".join(file.read_text()[-2000:] for file in self.state.glob("*.log"))
                raise TimeoutError(self.say("squeue", "--long") + logs)
            time.sleep(0.1)

    def submit(self, script, waiting=lambda: None, seconds=240):
        """Runs a printed script, waits until the queue is empty, and returns what all jobs printed."""
        subprocess.run(["sh"], input=script, env=self.environment, cwd=self.folder, stdout=subprocess.DEVNULL, text=True,
                       check=True)
        self.wait_for(lambda: waiting() or not self.say("squeue", "--noheader").strip(), seconds)
        return "".join(file.read_text() for file in sorted(self.folder.glob("slurm-*.out")))
