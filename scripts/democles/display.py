"""A display for VTK, which in Debian 12 draws through X only."""
import atexit
import ctypes
import os
import shutil
import signal
import subprocess

PR_SET_PDEATHSIG = 1  # linux/prctl.h


def end_with_parent():
    """In the server's process: also where VTK aborts the one that started it."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM)


def ensure():
    """Starts Xvfb, an X server without a screen, until this process ends, if there is no display.
    Says what is missing, or returns None. The server itself looks for a free number: xvfb-run,
    which looks before it starts one, gives two that start together the same."""
    if os.environ.get("DISPLAY"):
        return None
    if not shutil.which("Xvfb"):
        return "no display; install xvfb (scripts/setup does)"
    number, told = os.pipe()
    server = subprocess.Popen(
        # without -noreset it starts afresh when a window closes, and refuses the next meanwhile
        ["Xvfb", "-displayfd", str(told), "-noreset", "-nolisten", "tcp"]
        + ["-screen", "0", "1280x1024x24"],
        pass_fds=(told,),
        preexec_fn=end_with_parent,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(told)
    atexit.register(server.terminate)
    with os.fdopen(number) as pipe:
        display = pipe.readline().strip()
    if not display:
        return "no display, and Xvfb does not start"
    os.environ["DISPLAY"] = ":" + display
    return None
