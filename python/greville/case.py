"""Runs parameter files: Case and its helpers."""
import contextlib
import json
import os
import pty
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
from numbers import Integral
from pathlib import Path

from . import measured
from .results import Error, Run, how_to_install, path_of, read_parameter_text, read_table, read_text

PACKAGE = Path(__file__).resolve().parent
PROGRESS = re.compile(r"step \d+, t = (\S+) of (\S+) s")


class RunFailed(Error):
    """The program's message on a run that cannot begin or finish; output is all that it has printed."""

    def __init__(self, message, output=""):
        super().__init__(message)
        self.output = output


def program():
    """Return the program: $GREVILLE, else from the source tree or installation of this package, else from PATH."""
    installed = [folder / "bin/greville" for folder in list(PACKAGE.parents)[3:4]]
    candidates = [os.environ.get("GREVILLE"), PACKAGE.parents[1] / "build/greville", *installed, shutil.which("greville")]
    for candidate in candidates:
        if candidate and os.access(candidate, os.X_OK) and Path(candidate).is_file():
            return Path(candidate)
    raise RunFailed("There is no program greville: build or install it, or set the environment variable GREVILLE to its path.")


def project_file(name):
    """Return a file of the source tree or installation, such as 'scripts/build_umat' or 'prm/simulation/dam_break.prm'."""
    roots = [PACKAGE.parents[1]]
    if not (roots[0] / name).exists():
        prefix = program().resolve().parent.parent
        roots += [prefix, prefix / "share/greville"]
    for root in roots:
        if (root / name).exists():
            return root / name
    raise RunFailed(f"There is no {name} in {' or '.join(map(str, roots))}.")


def environment():
    """Return the environment of set_up_mpi in scripts/common.sh; variables that the caller has set are kept."""
    defaults = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1",
                "OMPI_MCA_hwloc_base_binding_policy": "none",
                "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
                "PRTE_MCA_hwloc_default_binding_policy": "none", "OMP_NUM_THREADS": "1", "DEAL_II_NUM_THREADS": "1",
                "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1:glibc.malloc.mmap_threshold=4294967296:"
                                  "glibc.malloc.trim_threshold=8589934592:glibc.malloc.top_pad=67108864"}
    if os.geteuid() == 0:
        defaults.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return {**defaults, **os.environ, "TERM": "xterm"}


def message_of(text):
    """Return the program's paragraph in the stderr output of a failed run, without the text of mpirun."""
    found = re.search(r"^greville: (.+?)(?=\n\s*\n|\n-{5,}|\Z)", text, re.MULTILINE | re.DOTALL)
    return (found.group(1) if found else text).strip() or "The program has ended without a message."


class Progress:
    """A bar in a notebook, or a line in a terminal."""

    def __init__(self):
        self.handle, self.is_terminal = None, sys.stderr.isatty()
        if "IPython" in sys.modules:
            from IPython import display, get_ipython
            if getattr(get_ipython(), "kernel", None):
                self.handle = display.display(display.HTML(""), display_id=True)

    def __call__(self, part, line):
        if self.handle:
            from IPython.display import HTML
            self.handle.update(HTML(f"<progress value='{part:.3f}' style='width:20em'></progress> <code>{line}</code>"))
        elif self.is_terminal:
            print(f"\r\033[K{line}", end="\n" if part >= 1. else "", file=sys.stderr, flush=True)


def check_number(name, n):
    """Refuse a number of processes that is no positive integer."""
    if not isinstance(n, Integral) or isinstance(n, bool) or n < 1:
        raise RunFailed(f"{name} has to be a whole number above zero, not {n!r}.")


def start(arguments, processes, terminal=True, **streams):
    """Start the program in its own session, so that Ctrl-C reaches it only through interrupt()."""
    command = [str(program()), *map(str, arguments)]
    if processes > 1:
        command = ["mpirun", "-np", str(processes), *command]
    # mpirun gives processes a terminal even if its own output is none.
    variables = environment() if terminal else {**environment(), "TERM": "dumb"}
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, env=variables, start_new_session=True, **streams)


def interrupt(process, processes):
    """Let the program write a checkpoint and end. mpirun would kill it before."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    with contextlib.suppress(OSError):   # The process has just ended.
        for pid in children.read_text().split() if processes > 1 else [process.pid]:
            os.kill(int(pid), signal.SIGINT)


def call(arguments, processes=1, progress=None):
    """Run the program, and return its output; progress(part, line) is called about five times a second."""
    check_number("processes", processes)
    if progress is not None and not callable(progress):
        raise RunFailed(f"progress has to be a function of the part that is done and a line, not {progress!r}.")
    lines, rest = [], b""
    # The program shows each step on a terminal, but only ten lines in a file.
    ours, theirs = pty.openpty()
    with tempfile.TemporaryFile() as messages:
        process = start(arguments, processes, stdout=theirs, stderr=messages)
        os.close(theirs)
        try:
            while True:
                # A process that has ended may have left the terminal to a child.
                if not select.select([ours], [], [], 0.2)[0]:
                    if process.poll() is None:
                        continue
                    break
                try:
                    text = os.read(ours, 65536)
                except OSError:   # A terminal signals its end by this error.
                    break
                *parts, rest = re.split(rb"[\r\n]+", rest + text)
                for line in (re.sub(r"\033\[[0-9;]*[A-Za-z]", "", part.decode(errors="replace")).rstrip() for part in parts):
                    found = PROGRESS.search(line)
                    if found and progress:
                        time, end = map(float, found.groups())
                        progress(min(1., time / end) if end > 0. else 0., line)
                    elif line and not found:
                        lines.append(line)
        except KeyboardInterrupt:
            interrupt(process, processes)
            raise
        finally:
            status = process.wait()
            os.close(ours)
        messages.seek(0)
        output = "\n".join(lines)
        if status:
            raise RunFailed(message_of(messages.read().decode(errors="replace")), output)
    return output


def as_text(value):
    """Return the value as text of a parameter file: lists with commas, lists of lists with semicolons between them."""
    if getattr(value, "ndim", None) == 0 and hasattr(value, "item"):   # A number of numpy.
        value = value.item() if value.dtype == bool else value[()]
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str) or not hasattr(value, "__iter__"):
        return str(value)
    parts = list(value)
    nested = any(not isinstance(part, str) and hasattr(part, "__iter__") for part in parts)
    return ("; " if nested else ", ").join(map(as_text, parts))


def as_value(text):
    """Return the number that the text represents, or the text."""
    for kind in (int, float):
        try:
            if str(kind(text)) == text:
                return kind(text)
        except ValueError:
            pass
    return text


def as_prm(tree, indent=""):
    """Return the text of a parameter file from nested sections; names may be paths as in 'Stage cut/Time/Step'."""
    result = ""
    for name, value in tree.items():
        *sections, name = str(name).split("/")
        for section in reversed(sections):
            name, value = section, {name: value}
        if isinstance(value, dict):
            result += f"{indent}subsection {name}\n{as_prm(value, indent + '  ')}{indent}end\n"
        elif value is None:
            raise RunFailed(f"The parameter <{name}> has no value.")
        else:
            result += f"{indent}set {name} = {as_text(value)}\n"
    return result


def check_repetitions(file, names):
    """Refuse duplicate names in a section."""
    for name in names:
        if names.count(name) > 1:
            raise RunFailed(f"{file} has <{name}> twice in one section.")


def dict_of(file, pairs):
    check_repetitions(file, [name for name, _ in pairs])
    return dict(pairs)


def import_yaml(file):
    try:
        import yaml
    except ImportError:
        raise RunFailed(f"{file} is YAML: " + how_to_install("yaml")) from None
    return yaml


def read_tree(file):
    """Return the sections of a JSON or YAML file."""
    text, yaml = read_text(file), None if file.suffix == ".json" else import_yaml(file)
    try:
        if yaml:
            class Loader(yaml.SafeLoader):
                def construct_mapping(self, node, deep=False):
                    check_repetitions(file, [name.value for name, _ in node.value])
                    return super().construct_mapping(node, deep)
            tree = yaml.load(text, Loader)
        else:
            tree = json.loads(text, object_pairs_hook=lambda pairs: dict_of(file, pairs))
    except (yaml.YAMLError if yaml else ValueError) as error:
        raise RunFailed(f"{file} is no {'YAML' if yaml else 'JSON'}: {error}.") from None
    if not isinstance(tree, dict):
        raise RunFailed(f"{file} has no sections.")
    return tree


def values_of(text):
    """Return the parameters in a text of the program by name."""
    return {name: line.value for name, line in read_parameter_text(text).items()}


def folder_of(parameters):
    """Return the result folder of a run with these parameters."""
    return Path(parameters["Output/Directory"] or f"output/{parameters['Simulation/Name']}")


class Case:
    """A problem: a parameter file (.prm, .json, .yaml), a template by its name, or sections as a dict, with settings.

    JSON, YAML and dicts have nested sections with the names of a .prm file. Lists become values with
    commas, and lists of lists have semicolons between them.
    """

    def __init__(self, source, **settings):
        self.settings, self.tree, self.folder = {}, None, Path()
        if isinstance(source, dict):
            self.tree, self.name = source, "case"
        else:
            self.file = path_of(source)
            self.name, self.folder = self.file.stem, self.file.parent
            if not self.file.is_file():
                raise RunFailed(f"There is no file {source}.")
            if self.file.suffix in (".json", ".yaml", ".yml"):
                self.tree = read_tree(self.file)
        for name, value in settings.items():
            self.set(name, value)

    @classmethod
    def new(cls, template, file=None):
        """Copy a template of the program, such as 'slope', to FILE, like greville --new, and return its Case."""
        call(["--new", template, *([file] if file else [])])
        return cls(file or f"{template}.prm")

    def set(self, name, value):
        """Replace a parameter, such as 'Material clay/Cohesion', and return the case."""
        if value is None:
            raise RunFailed(f"The parameter <{name}> has no value.")
        text = as_text(value)
        # The command line does not support these.
        if any(character == "\0" or "\ud800" <= character <= "\udfff" for character in f"{name}{text}"):
            raise RunFailed(f"The parameter {name!r} is {text!r}, which has characters that no file can have.")
        self.settings[name] = text
        return self

    def copy(self):
        result = object.__new__(type(self))
        result.__dict__.update(self.__dict__, settings=dict(self.settings))
        return result

    def as_prm(self):
        """Return the sections of a dict, JSON or YAML as the text of a parameter file, without settings."""
        return f"subsection Simulation\n  set Name = {self.name}\nend\n" + as_prm(self.tree)

    def _call(self, *options, processes=1, progress=None):
        options += tuple(word for name, value in self.settings.items() for word in ("--set", f"{name}={value}"))
        if self.tree is None:
            return call([self.file, *options], processes, progress)
        # File names in it are relative to the file, so it must be in the folder of the original.
        descriptor, file = tempfile.mkstemp(".prm", f".{self.name}_", self.folder, text=True)
        try:
            with os.fdopen(descriptor, "w", encoding="utf-8") as stream:
                stream.write(self.as_prm())
            return call([file, *options], processes, progress).replace(file, self.name)
        except RunFailed as error:
            raise RunFailed(str(error).replace(file, self.name), error.output) from None
        finally:
            os.unlink(file)

    @property
    def parameters(self):
        """Return all parameters of a run, as text by name."""
        return values_of(self._call("--print-parameters"))

    def save(self, file):
        """Write all parameters that are not defaults as .prm, .json or .yaml. This package reads all three."""
        tree, file = {}, Path(file)
        for name, line in read_parameter_text(self._call("--print-parameters")).items():
            *sections, name = name.split("/")
            if line.default is not None or name == "Model":   # It has no default.
                section = tree
                for part in sections:
                    section = section.setdefault(part, {})
                section[name] = as_value(line.value)
        if file.suffix == ".prm":
            text = as_prm(tree)
        elif file.suffix == ".json":
            text = json.dumps(tree, indent=2, ensure_ascii=False) + "\n"
        else:
            text = import_yaml(file).safe_dump(tree, sort_keys=False, allow_unicode=True)
        file.write_text(text, encoding="utf-8")

    def check(self):
        """Return the estimated cost of a run as text: sizes, step, time and memory."""
        return self._call("--check")

    @property
    def results(self):
        """Return the result folder."""
        return folder_of(self.parameters)

    def run(self, processes=1, progress=None, resume=False):
        """Run the program, and return the Run; progress(part, line) replaces the progress bar or line."""
        folder = self.results
        output = self._call(*(["--resume"] if resume else []), processes=processes, progress=progress or Progress())
        run = Run(folder)
        run.output = output + measured.add_to_summary(run)
        return run

    def element_test(self, test, material=None):
        """Return the Table of a laboratory test of a material, such as 'triaxial-drained'."""
        self._call("--element-test", test, *(["--material", material] if material else []))
        return read_table(self.results / "element_test.csv")


def build_umat(file, library=None):
    """Compile a UMAT to a shared library (scripts/build_umat), and return its path."""
    done = subprocess.run(["sh", project_file("scripts/build_umat"), file, *([library] if library else [])],
                          capture_output=True, text=True)
    if done.returncode:
        raise RunFailed(done.stderr.strip())
    return Path(done.stdout.strip()).resolve()
