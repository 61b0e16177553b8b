"""``ehlpetsc post RESULT.h5 [...]``: damage, statistics and pictures."""

import os
import signal


def _stop(*_):
    """Stop during the imports, before there is any work to end properly."""
    os.write(2, b"ehlpetsc.post: stopped before anything was computed\n")
    os._exit(4)


if __name__ == "__main__":
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, _stop)
    from ehlpetsc.post.command import command

    command()
