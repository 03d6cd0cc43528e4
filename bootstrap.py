#!/usr/bin/env python3
"""Make the environment once, then run a verb: ``python3 bootstrap.py VERB [arguments]``.

``test`` runs the tests with pytest; every other verb goes to ``navsym``. The first run makes
``.venv`` beside this file and installs the versions of ``requirements.lock``, checked by
their hashes. A stamp, written last, lets later runs start at once. Only the standard library
is used, and only syntax that an old Python can still read, so that it can be refused politely.
"""

import contextlib
import hashlib
import json
import os
import shutil
import subprocess
import sys

SUPPORTED = ((3, 11), (3, 12), (3, 13))
ROOT = os.path.dirname(os.path.realpath(__file__))
LOCK = "requirements.lock"
EXTRAS = "requirements-extra.lock"  # jupyterlab, documentation, cross compilers, GeoTIFF, fuzzing
INPUTS = (LOCK, "pyproject.toml")
STAMP = "navsym-stamp.json"
MINE = "navsym-bootstrap"  # stands in every environment made here; nothing else is ever removed
MISSING = 3  # exit status: this machine lacks something

# Settings of pip that would put the packages elsewhere, or other packages here. Where packages
# come from (index, mirror, folder of wheels, proxy, certificates) stays as the user has it.
ASTRAY = (
    "USER",
    "TARGET",
    "PREFIX",
    "ROOT",
    "REQUIREMENT",
    "CONSTRAINT",
    "REQUIRE_VIRTUALENV",
    "DRY_RUN",
    "IGNORE_INSTALLED",
    "NO_BINARY",
    "NO_DEPS",
    "REPORT",
    "QUIET",
    "VERBOSE",
)

# The whole suite runs on two cores, group by group: what a group prepares is prepared once (tests/conftest.py). A
# worker that dies is replaced once, not for ever: the group that killed it is run again.
WHOLE = ["-n", "2", "--dist", "loadgroup", "--no-loadscope-reorder", "--max-worker-restart", "1"]

USAGE = """usage: python3 bootstrap.py VERB [arguments]

  test [pytest arguments]   run the tests
  extras                    add jupyterlab, sphinx, cross compilers, GeoTIFF and atheris to the environment
  doctor                    what this machine lacks
  --help                    this text, then every verb of navsym

The first run makes the environment .venv and installs the locked packages."""


class Trouble(Exception):
    """Something this machine lacks; the text says what to do."""


def refusal(version: "tuple[int, int]") -> "str | None":
    """Why this Python cannot be used, or None when it can."""
    if tuple(version[:2]) in SUPPORTED:
        return None
    names = ["python%d.%d" % pair for pair in reversed(SUPPORTED)]
    found = [name for name in names if shutil.which(name)]
    advice = "run `%s bootstrap.py`" % found[0] if found else "install one of them and run it again"
    return "expected Python 3.11, 3.12 or 3.13; got %d.%d; %s" % (version[0], version[1], advice)


def say(text: str) -> None:
    """A remark on standard error: standard output belongs to the verb."""
    print("navsym: " + text, file=sys.stderr, flush=True)


# The environment and its stamp


def wanted(root: str) -> "dict[str, str]":
    """What the stamp says when the environment in ``root`` is complete and up to date."""
    digest = hashlib.sha256()
    for name in INPUTS:
        with open(os.path.join(root, name), "rb") as file:
            digest.update(file.read() + b"\0")
    return {
        "inputs": digest.hexdigest(),
        "python": "%s %s" % (sys.version.split()[0], os.path.realpath(sys.base_prefix)),
        "root": root,
    }


def read_stamp(venv: str) -> "dict[str, str] | None":
    """The stamp of an environment; None when there is none or it cannot be read."""
    try:
        with open(os.path.join(venv, STAMP), encoding="utf-8") as file:
            stamp = json.load(file)
    except (OSError, ValueError):
        return None
    return stamp if isinstance(stamp, dict) else None


def write_stamp(venv: str, stamp: "dict[str, str]") -> None:
    """Write the stamp in one step, so that it is there whole or not at all."""
    path = os.path.join(venv, STAMP)
    with open(path + ".new", "w", encoding="utf-8") as file:
        json.dump(stamp, file, indent=1)
        file.flush()
        os.fsync(file.fileno())
    os.replace(path + ".new", path)


def drop_stamp(venv: str) -> None:
    """From here on the environment counts as unfinished."""
    with contextlib.suppress(OSError):
        os.remove(os.path.join(venv, STAMP))


def python_of(venv: str) -> str:
    """Path of the interpreter of an environment."""
    inside = ("Scripts", "python.exe") if os.name == "nt" else ("bin", "python")
    return os.path.join(venv, *inside)


def is_ours(venv: str) -> bool:
    """True when the folder may be filled or replaced: absent, empty, or made here."""
    if os.path.islink(venv):
        return False
    if not os.path.exists(venv):
        return True
    return os.path.isdir(venv) and (not os.listdir(venv) or os.path.exists(os.path.join(venv, MINE)))


def choose(root: str) -> str:
    """The folder of the environment: ``.venv``, or another when somebody else made that one."""
    first = os.path.join(root, ".venv")
    return first if is_ours(first) else os.path.join(root, ".venv-navsym")


def state(venv: str, stamp: "dict[str, str]") -> str:
    """``ready``, ``stale`` (the lock changed: update in place) or ``absent`` (make it from scratch)."""
    have = read_stamp(venv)
    if have is None or not os.path.exists(python_of(venv)):
        return "absent"
    if have == stamp:
        return "ready"
    same_place = all(have.get(key) == stamp[key] for key in ("python", "root"))
    return "stale" if same_place else "absent"


# Making it


def quiet_environment() -> "dict[str, str]":
    """Our environment variables without those that lead pip or the child interpreter astray."""
    drop = {"PYTHONHOME", "PYTHONPATH", "__PYVENV_LAUNCHER__", "VIRTUAL_ENV"}
    drop |= {"PIP_" + name for name in ASTRAY}
    env = {key: value for key, value in os.environ.items() if key not in drop}
    env.update(PIP_DISABLE_PIP_VERSION_CHECK="1", PIP_NO_INPUT="1", PIP_ROOT_USER_ACTION="ignore")
    return env


def run(command: "list[str]", advice: str) -> None:
    """Run one step quietly; when it fails, show its last lines and the advice."""
    done = subprocess.run(command, cwd=ROOT, env=quiet_environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode:
        lines = done.stdout.decode("utf-8", "replace").strip().splitlines()
        print("\n".join("  " + line for line in lines[-8:]), file=sys.stderr)
        raise Trouble(advice)


def make_venv(venv: str) -> None:
    """An empty environment with pip, from scratch; the mark goes in first."""
    shutil.rmtree(venv, ignore_errors=True)
    os.makedirs(venv, exist_ok=True)
    with open(os.path.join(venv, MINE), "w", encoding="utf-8") as file:
        file.write("made by bootstrap.py of navsym; safe to delete\n")
    advice = (
        "this Python cannot make an environment with pip; install its venv and ensurepip parts "
        "(Debian and Ubuntu: apt install python%d.%d-venv) and run the same command again"
    )
    run([sys.executable, "-m", "venv", venv], advice % sys.version_info[:2])


def locked(lock: str = LOCK) -> int:
    """How many packages a lock holds."""
    with open(os.path.join(ROOT, lock), encoding="utf-8") as file:
        return sum("==" in line for line in file)


def install_locked(venv: str, lock: str) -> None:
    """The packages of a lock, by their hashes."""
    advice = (
        "pip could not install the locked packages; this needs a network, a mirror in PIP_INDEX_URL, or "
        "PIP_NO_INDEX=1 with PIP_FIND_LINKS=/folder/of/wheels; then run the same command again, "
        "finished downloads are kept"
    )
    run([python_of(venv), "-m", "pip", "install", "--quiet", "--require-hashes", "-r", lock], advice)


def install(venv: str) -> None:
    """The locked packages, then this checkout itself, editable."""
    install_locked(venv, LOCK)
    run(
        [
            python_of(venv),
            "-m",
            "pip",
            "install",
            "--quiet",
            "--no-deps",
            "--no-build-isolation",
            "--no-index",
            "-e",
            ".",
        ],
        "pip could not install this checkout; is it complete?",
    )


def install_extras(venv: str) -> None:
    """What is optional; the locked packages that are there already stay as they are."""
    say(
        "adding the optional packages of %s to %s (%d with their needs)"
        % (EXTRAS, os.path.basename(venv), locked(EXTRAS))
    )
    with alone(ROOT):
        install_locked(venv, EXTRAS)
    say("the optional packages are ready")


@contextlib.contextmanager
def alone(root: str) -> "object":
    """Only one process at a time makes the environment; the others wait for it."""
    try:
        import fcntl
    except ImportError:  # Windows: two first runs at once are the user's to avoid
        yield
        return
    with open(os.path.join(root, "bootstrap.py"), "rb") as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another run that is making the environment")
            fcntl.flock(file, fcntl.LOCK_EX)
        except OSError:  # a file system without locks
            say("this file system has no locks; let only one first run at a time go")
        yield


def prepare(root: str) -> str:
    """Bring the environment up to date and return its interpreter."""
    venv, stamp = choose(root), wanted(root)
    if not is_ours(venv):
        raise Trouble("%s was not made by bootstrap.py; move it away and run again" % venv)
    if state(venv, stamp) != "ready":
        with alone(root):
            update(venv, stamp)
    return python_of(venv)


def update(venv: str, stamp: "dict[str, str]") -> None:
    """Make or refresh the environment; the stamp is dropped first and written last."""
    found = state(venv, stamp)
    if found == "ready":  # another run finished while this one waited
        return
    drop_stamp(venv)
    name = os.path.basename(venv)
    if found == "absent":
        say("making %s with Python %s" % (name, sys.version.split()[0]))
        make_venv(venv)
        say("installing %d locked packages into %s (a minute or two, once)" % (locked(), name))
    else:
        say("bringing %s up to date with the lock" % name)
    install(venv)
    write_stamp(venv, stamp)
    say("the environment is ready")


# Running


def command_for(python: str, arguments: "list[str]") -> "list[str]":
    """The command line of a verb: pytest for ``test``, navsym for everything else."""
    if arguments[0] == "test":
        given = arguments[1:] or (WHOLE if (os.cpu_count() or 1) > 1 else [])
        return [python, "-m", "pytest", *given]
    return [python, "-P", "-m", "navsym", *arguments]  # -P: no module is taken from the user's folder


def hand_over(command: "list[str]") -> int:
    """Become the command; where a process cannot do that, run it and pass its status on."""
    drop = ("PYTHONHOME", "__PYVENV_LAUNCHER__")
    env = {key: value for key, value in os.environ.items() if key not in drop}
    if os.name == "nt":
        return subprocess.run(command, env=env).returncode
    os.execve(command[0], command, env)
    return 0  # never reached


def fail(message: str, as_json: bool) -> int:
    """Say what is missing, as text and, when asked for, as the document of the interfaces."""
    if as_json:
        print(json.dumps({"error": {"kind": "missing", "where": "bootstrap.py", "message": message}}))
    say(message)
    return MISSING


def main(arguments: "list[str]") -> int:
    """Refuse, prepare, run; returns the exit status when it does not become the command."""
    as_json = "--json" in arguments
    message = refusal(sys.version_info[:2])
    if message:
        return fail(message, as_json)
    if not arguments or arguments[0] in ("-h", "--help"):
        print(USAGE, flush=True)
        if not arguments:
            return 2
    try:
        python = prepare(ROOT)
        if arguments[0] == "extras":
            install_extras(choose(ROOT))
            return 0
    except Trouble as trouble:
        return fail(str(trouble), as_json)
    except OSError as error:
        advice = "expected a place to write the environment; got %s; make room or move the checkout"
        return fail(advice % error, as_json)
    except KeyboardInterrupt:
        say("interrupted; the next run starts the environment afresh")
        return 130
    if arguments[0] == "test":
        os.chdir(ROOT)
    return hand_over(command_for(python, arguments))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
