"""MSK on the nodes of a cluster, by `Ray <https://docs.ray.io>`_ (``pip install "msk[ray]"``).

* :func:`evaluate` and :func:`collect`, and the commands ``python -m msk.ray eval`` and ``python -m msk.ray collect``, play the episodes of an
  evaluation or of a data set in shards. The results have the bytes of one machine.
* :class:`Collector` collects rollouts for a learner: an actor on each node steps episodes under a policy, in Rust threads.
"""

from .collector import Collector
from .policies import Policy
from .rollout import Rollout, Seconds
from .shards import Timing, collect, evaluate

__all__ = ["Collector", "Policy", "Rollout", "Seconds", "Timing", "collect", "evaluate"]
