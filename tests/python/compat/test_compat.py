"""python -m manyhands.compat: old programs, unchanged."""

from pathlib import Path
from textwrap import dedent

import pytest
from programs import output, run

COMPAT = ("-m", "manyhands.compat")

PROGRAM = """
    import sys

    import __main__
    import beside
    import gym
    import pybullet as p
    from pybullet_utils.bullet_client import BulletClient

    assert p is sys.modules["manyhands.pybullet"] and "manyhands" in gym.__file__
    seen = "by others"
    assert __main__.seen == seen
    client = BulletClient(p.DIRECT)
    print(sys.argv, __name__, __file__, sys.path[0], __spec__, beside.__name__, client.isConnected())
"""


def test_a_program_is_the_main_module(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "beside.py").write_text("")
    (tmp_path / "inner" / "program.py").write_text(dedent(PROGRAM))
    done = output(tmp_path, "", *COMPAT, "inner/program.py", "-m", "--keep", "x")
    folder = str((tmp_path / "inner").resolve())
    file = str(tmp_path / "inner" / "program.py")
    expected = f"['inner/program.py', '-m', '--keep', 'x'] __main__ {file} {folder} None beside 1\n"
    assert done.endswith(expected)


def test_a_module(tmp_path: Path) -> None:
    (tmp_path / "package").mkdir()
    (tmp_path / "package" / "__init__.py").write_text("")
    (tmp_path / "package" / "tool.py").write_text("import sys, gym\nprint(sys.argv[1:], __name__, gym.__name__)\n")
    assert output(tmp_path, "", *COMPAT, "-m", "package.tool", "--keep") == "['--keep'] __main__ manyhands.gym\n"


@pytest.mark.parametrize(
    "program",
    [
        "def f():\n    raise ValueError('wrong')\nf()\n",
        "x = (1\n",
        "import sys\nsys.exit(7)\n",
        "import sys\nsys.exit('no')\n",
        "print('done')\n",
        "raise SystemExit\n",
    ],
)
def test_a_program_ends_as_in_python(tmp_path: Path, program: str) -> None:
    alone = run(tmp_path, str(tmp_path / "program.py"), program=program)
    ours = run(tmp_path, *COMPAT, str(tmp_path / "program.py"))
    assert (ours.returncode, ours.stdout, ours.stderr) == (alone.returncode, alone.stdout, alone.stderr)


def test_a_name_may_be_kept(tmp_path: Path) -> None:
    program = "import gym, panda_gym\nprint(gym.__name__, panda_gym.__name__)\n"
    assert output(tmp_path, program, *COMPAT, "--keep", "panda_gym", "program.py") == "manyhands.gym panda_gym\n"


def test_processes_that_a_program_starts(tmp_path: Path) -> None:
    program = """
        import multiprocessing
        import subprocess
        import sys

        import gym
        from gym.wrappers.time_limit import TimeLimit

        def work(queue):
            import pybullet_utils.bullet_client as client
            queue.put((gym.__name__, TimeLimit.__module__, client.__name__))

        if __name__ == "__main__":
            context = multiprocessing.get_context("spawn")
            queue = context.Queue()
            process = context.Process(target=work, args=(queue,))
            process.start()
            print(*queue.get(timeout=60), flush=True)
            process.join()
            subprocess.run([sys.executable, "-c", "import gym.envs; print(gym.envs.__name__)"], check=True)
    """
    assert output(tmp_path, program, *COMPAT, "program.py") == (
        "manyhands.gym manyhands.gym.wrappers.time_limit manyhands.pybullet_utils.bullet_client\nmanyhands.gym.envs\n"
    )


def test_help_teaches(tmp_path: Path) -> None:
    text = output(tmp_path, "", *COMPAT, "--help")
    assert "python -m manyhands.compat hello_pybullet.py" in text
    assert "manyhands.install_as(" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "name a program or -m MODULE to run"),
        (("no_such.py",), "there is no file 'no_such.py' to run"),
        (("--keep", "numpy", "program.py"), "invalid choice: 'numpy'"),
        (("--quick", "program.py"), "unrecognized arguments: --quick"),
    ],
)
def test_requests_that_make_no_sense(tmp_path: Path, arguments: tuple[str, ...], message: str) -> None:
    done = run(tmp_path, *COMPAT, *arguments)
    assert done.returncode == 2
    assert message in done.stderr
