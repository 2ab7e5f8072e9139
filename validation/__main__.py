"""python3 -m validation, or python3 -m photorque.prove where the module is installed: see prove.py."""

import os
import sys

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # cases run in parallel

from .prove import main  # noqa: E402

sys.exit(main())
