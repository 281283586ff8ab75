# SPDX-License-Identifier: BSD-3-Clause
"""Runs a script in a fork of a pvpython that has started once for all tests.

    python3 forked.py PVPYTHON SCRIPT [ARGUMENT...]     like: pvpython --force-offscreen-rendering SCRIPT ARGUMENT...

Starting ParaView takes more than two seconds of processor time, forking takes none. The first test in a run of ctest
starts this pvpython, which ends with ctest. Each script has its own process: scripts cannot disturb each other. It ends
without ParaView's own exit, which tests in real time, of ranks, of windows and of servers try.
"""
import errno
import json
import os
import runpy
import select
import signal
import socket
import struct
import subprocess
import sys
import traceback

LOG = os.path.join(os.environ["LACUNA_TEST_OUTPUT"], "forked.log")


def check_user(connection):
    """Only the same user may run scripts, or get them to run."""
    user = struct.unpack("3i", connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, struct.calcsize("3i")))[1]
    if user != os.getuid():
        sys.exit("another user has taken the name of the socket")


def start(pvpython, name):
    """Starts the pvpython that forks, unless another test does so now."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        try:
            listener.bind(name)
        except OSError as error:
            if error.errno != errno.EADDRINUSE:
                raise
            return
        listener.listen(100)
        os.makedirs(os.path.dirname(LOG), exist_ok=True)
        with open(LOG, "w", encoding="utf-8") as log:
            subprocess.Popen([pvpython, "--force-offscreen-rendering", os.path.abspath(__file__), str(listener.fileno()), str(os.getppid())],
                             pass_fds=[listener.fileno()], stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True)


def run_there(pvpython, arguments):
    """The status of the script's process, as of os.waitpid."""
    name = f"\0lacuna-{os.getuid()}-{os.getppid()}"  # of this ctest
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as connection:
        while connection.connect_ex(name) == errno.ECONNREFUSED:
            start(pvpython, name)
        check_user(connection)
        socket.send_fds(connection, [json.dumps([os.getcwd(), dict(os.environ), arguments]).encode()], [0, 1, 2])
        status = connection.recv(4)
    if not status:
        sys.exit(f"{pvpython} has ended: see {LOG}")
    return struct.unpack("i", status)[0]


def serve(listener, ctest):
    """Forks for each test until ctest ends."""
    import paraview.simple  # noqa: F401
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for the forks
    os.nice(10)  # tests in real time run beside
    listener.settimeout(1)
    while os.path.exists(f"/proc/{ctest}"):
        try:
            connection = listener.accept()[0]
        except TimeoutError:
            continue
        if os.fork() == 0:
            listener.close()
            try:
                serve_one(connection, ctest)
            finally:
                os._exit(1)  # never into ParaView's exit, where a fork hangs
        connection.close()


def serve_one(connection, ctest):
    """Runs a script in another fork, and kills it when its test ends first (ctest's time is up), or ctest itself."""
    check_user(connection)
    message, files, _, _ = socket.recv_fds(connection, 1 << 20, 3)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)
    script = os.fork()
    if script == 0:
        connection.close()
        run_here(files, *json.loads(message))
    for file in files:
        os.close(file)
    ended = os.pidfd_open(script)
    ready = []
    while not ready and os.path.exists(f"/proc/{ctest}"):
        ready = select.select([connection, ended], [], [], 1)[0]
    if ended not in ready:
        os.killpg(script, signal.SIGKILL)
    status = os.waitpid(script, 0)[1]
    if ended in ready:
        connection.send(struct.pack("i", status))


def run_here(files, folder, environment, arguments):
    """Runs a script in this process, which ends with it."""
    os.setpgid(0, 0)
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    os.environ.clear()
    os.environ.update(environment)
    os.chdir(folder)
    sys.argv = arguments
    sys.path[0] = os.path.dirname(arguments[0])
    status = 1
    try:
        runpy.run_path(arguments[0], run_name="__main__")
        status = 0
    except SystemExit as stop:
        if isinstance(stop.code, str):
            print(stop.code, file=sys.stderr)
        else:
            status = stop.code or 0
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if sys.argv[1].isdigit():
    serve(socket.socket(fileno=int(sys.argv[1])), sys.argv[2])
else:
    result = run_there(sys.argv[1], sys.argv[2:])
    if os.WIFSIGNALED(result):
        os.kill(os.getpid(), os.WTERMSIG(result))
    sys.exit(os.WEXITSTATUS(result))
