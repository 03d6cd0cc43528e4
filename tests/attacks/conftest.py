"""The watch that every hostile file is read under: nothing may run, and the refusal must help."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from navsym.core.errors import NavsymError
from navsym.models.modelfile import read_model
from navsym.prove.claimfile import read_claims

# Whatever starts code, a process or a connection, or writes a file, while a payload is being read.
HEARD: list[str] = []
ARMED = False
PROCESSES = {
    "os.system",
    "os.exec",
    "os.posix_spawn",
    "os.fork",
    "os.forkpty",
    "subprocess.Popen",
    "socket.connect",
    "pty.spawn",
    "ctypes.dlopen",
    "os.remove",
    "os.rename",
    "os.mkdir",
    "shutil.rmtree",
    "pickle.find_class",
}


def listen(event, arguments):
    if not ARMED:
        return
    if event in PROCESSES:
        HEARD.append(event)
    elif event == "compile" and not from_a_module(str(arguments[1])):
        HEARD.append(f"compile {arguments[1]}")
    elif event == "exec" and not from_a_module(arguments[0].co_filename):
        HEARD.append(f"exec {arguments[0].co_filename}")
    elif event == "open" and isinstance(arguments[1], str) and set(arguments[1]) & set("wax+"):
        HEARD.append(f"open {arguments[0]!r} {arguments[1]}")


def from_a_module(filename):
    """The algebra loads parts of itself on first use; a payload would come from no file."""
    return filename.endswith(".py") and os.path.isabs(filename)


sys.addaudithook(listen)


def heard_during(action):
    """What the watch hears while ``action`` runs."""
    global ARMED
    HEARD.clear()
    ARMED = True
    try:
        action()
    finally:
        ARMED = False
    return list(HEARD)


def check_refusal(read, path, kind):
    caught, seconds = [], []

    def attempt():
        started = time.process_time()
        with pytest.raises(NavsymError) as info:
            read(path)
        seconds.append(time.process_time() - started)
        caught.append(info.value)

    assert heard_during(attempt) == []
    if seconds[0] >= 1.0:  # processor time doubles on a shared core: the better of two readings
        attempt()
    error = caught[0]
    assert not list(Path(path).parent.glob("**/PWNED")) and not Path("PWNED").exists()
    assert (error.kind, error.status) == (kind, 2), str(error)
    assert error.where.startswith(str(path))
    assert error.message.startswith("expected ") and error.expected and error.got and error.remedy
    assert len(str(error)) < 1000 and str(error).isprintable()
    assert min(seconds) < 1.0


@pytest.fixture(scope="session")
def listen_to():
    return heard_during


@pytest.fixture
def refused(tmp_path, monkeypatch):
    """``refused(read, path, kind)``: a NavsymError of that kind, in time, and nothing has run."""
    monkeypatch.chdir(tmp_path)
    return check_refusal


WARM_MODEL = """[model]
states = ["x"]
F = [["abs(sin(exp(2)))*tan(w)**(1/3)/(sqrt(2) + 1)"]]
[parameters]
w = ["1/2", "2"]
[[measurement]]
h = ["1"]
[interval]
T = "pi - 3"
"""


@pytest.fixture(scope="session", autouse=True)
def the_algebra_is_loaded(tmp_path_factory):
    """Everything that an honest file needs is imported before anything is timed or listened to."""
    folder = tmp_path_factory.mktemp("honest")
    (folder / "m.toml").write_text(WARM_MODEL)
    (folder / "c.toml").write_text('[[claim]]\nid = "a"\nleft = "1"\nright = "1"\n')
    read_model(folder / "m.toml")
    read_claims(folder / "c.toml")
