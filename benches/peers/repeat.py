"""One case's work on frfid's side, done so many times, for valgrind to count: repeat.py WORKLOAD INDEX TIMES"""

import itertools
import sys

import workloads

name, index, times = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
case = next(itertools.islice(workloads.cases(name, small=True), index, None))
for _ in range(times):
    case.ours()
