"""Read at the start of Python where PYTHONPATH names this directory: what ParaView 5.11 asks for and Python 3.11 no longer has.

Of what it returned ParaView reads the first field only, `args`, which its successor has too.
"""

import inspect

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec
