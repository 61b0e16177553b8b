"""A page in a browser, without a window and a network."""

import json
import re
import shutil
import subprocess

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = """headless no-sandbox disable-gpu disable-quic no-first-run disable-background-networking
disable-component-update disable-sync window-size=1200,2400 virtual-time-budget=9000 dump-dom""".split()


def visited(path, script):
    """What a script added to a page leaves as JSON in an output element."""
    text = path.read_text(encoding="utf-8").replace("<head>", f"<head><script>{script}</script>")
    path.write_text(text, encoding="utf-8")
    options = [*FLAGS, f"user-data-dir={path.parent / 'profile'}", "host-resolver-rules=MAP * ~NOTFOUND"]
    command = [BROWSER, *(f"--{option}" for option in options), path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    (answer,) = re.findall("<output>(.*?)</output>", done.stdout)
    return json.loads(answer)
