"""Runs a program again and again: with a process of its own each time, or as copies of one that has started."""
import os
import pathlib
import resource
import select
import signal
import struct
import subprocess
import sys

REQUESTS, ANSWERS = 198, 199  # descriptors, as in fork_server.c


def processor_s():
    """Seconds of a processor that the processes which this one started and which ended have used."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


class Started:
    """Starts the program anew for each run."""
    memory = 0  #: Most bytes that the last run held; here it is not known.

    def __init__(self, words, folder, environment, limits_s):
        self.words, self.folder, self.environment = words, folder, environment
        self.wall_s, self.processor_s = limits_s

    def run(self):
        """Returns exit code (negative for a signal, None beyond the limits), standard output and error."""
        used = processor_s()
        with subprocess.Popen(self.words, cwd=self.folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, env=self.environment) as child:
            try:
                out, err = child.communicate(timeout=self.wall_s)
            except subprocess.TimeoutExpired:
                child.kill()
                child.communicate()
                return None, b"", b""
        return None if processor_s() - used > self.processor_s else child.returncode, out, err

    def close(self):
        pass


class Copied:
    """Starts the program once. Each run is a copy of that process, made where `main` begins (fork_server.c)."""
    def __init__(self, words, folder, environment, limits_s, server):
        self.wall_s, self.processor_s = limits_s
        self.files = [open(pathlib.Path(environment["TMPDIR"]).with_name(name), "a+b", buffering=0)
                      for name in ("out", "err")]
        theirs, self.requests = os.pipe()
        self.answers, their_answers = os.pipe()
        environment = {**environment, "LD_PRELOAD": str(server)}
        actions = [(os.POSIX_SPAWN_DUP2, theirs, REQUESTS), (os.POSIX_SPAWN_DUP2, their_answers, ANSWERS),
                   (os.POSIX_SPAWN_OPEN, 0, os.devnull, os.O_RDONLY, 0)]
        actions += [(os.POSIX_SPAWN_DUP2, file.fileno(), number) for file, number in zip(self.files, (1, 2))]
        here = os.getcwd()
        os.chdir(folder)  # What is spawned inherits it.
        self.server = os.posix_spawn(words[0], words, environment, file_actions=actions)
        os.chdir(here)
        os.close(theirs)
        os.close(their_answers)

    def answer(self, form):
        size = struct.calcsize(form)
        data = b""
        while len(data) < size:
            part = os.read(self.answers, size - len(data))
            if not part:
                raise SystemExit("mutate: the server of processes has ended")
            data += part
        return struct.unpack(form, data)[0]

    def run(self):
        """Returns exit code (negative for a signal, None beyond the limits), standard output and error."""
        os.write(self.requests, b"r")
        child = self.answer("i")
        late = not select.select([self.answers], [], [], self.wall_s)[0]
        if late:
            os.kill(child, signal.SIGKILL)
        status, used_us, self.memory = self.answer("i"), self.answer("q"), self.answer("q") << 10
        texts = [self.take(file) for file in self.files]
        if late or used_us > self.processor_s * 1e6:
            return None, *texts
        return os.waitstatus_to_exitcode(status), *texts

    @staticmethod
    def take(file):
        """Returns what a run has written and empties the file."""
        file.seek(0)
        data = file.read()
        if data:
            file.truncate(0)
        return data

    def close(self):
        os.close(self.requests)
        os.close(self.answers)
        os.waitpid(self.server, 0)
        for file in self.files:
            file.close()


def build_server(folder):
    """Compiles fork_server.c into the folder. Returns the library, or None without a compiler or on another system."""
    library = pathlib.Path(folder, "fork_server.so")
    source = pathlib.Path(__file__).with_name("fork_server.c")
    compiler = os.environ.get("CC", "cc")
    if not sys.platform.startswith("linux"):
        return None
    try:
        subprocess.run([compiler, "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    except (OSError, subprocess.CalledProcessError):
        return None
    return library
