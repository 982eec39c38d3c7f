# SPDX-License-Identifier: GPL-3.0-or-later
"""Dealing pings to ranks, event by event, as src/run/ranks/run_lead.cpp, run_helper.cpp and ping_workers.cpp do it."""
import collections
import dataclasses
import heapq
import math

import numpy

AHEAD_S, MOST_AHEAD, REST_S = 0.1, 1000, 0.001  # ping_workers.cpp


@dataclasses.dataclass
class Costs:
    """What a run costs beside its pings, in seconds; all zero is a run that only computes."""
    load: float = 0      # on each rank
    result: float = 0    # of rank 0's time, for a ping that another rank computed
    request: float = 0   # of rank 0's time, for a request and its answer
    write: float = 0     # of files, a ping, after the last
    finish: float = 0    # of files, whatever the pings
    launch: float = 0    # of processes

    def free_lead(self):
        return dataclasses.replace(self, result=0, request=0)


def resampled(measured, count, block, seed):
    """`count` ping seconds: blocks of a measured series, wherever they begin, so that neighbours stay alike."""
    draw = numpy.random.default_rng(seed)
    starts = draw.integers(0, len(measured), -(-count // block))
    return numpy.concatenate([numpy.take(measured, range(s, s + block), mode="wrap") for s in starts])[:count]


def correlation(series, lag=1):
    """Serial correlation of ping seconds."""
    if len(series) <= lag or series.std() == 0:
        return 0.0
    return float(numpy.corrcoef(series[:-lag], series[lag:])[0, 1])


class Rank:
    """A PingWorkers and the thread that sees to its messages."""
    def __init__(self, threads, begun):
        self.idle, self.begun, self.done = threads, begun, 0
        self.stock, self.results, self.answers = collections.deque(), 0, []
        self.asked = self.closed = self.sending = False

    def wanted(self, now):
        if self.closed:
            return 0
        ahead = 0
        if self.done:
            each = (now - self.begun) / self.done
            ahead = MOST_AHEAD if each * MOST_AHEAD < AHEAD_S else int(AHEAD_S / each)
        return self.idle + 2 * ahead - len(self.stock) if len(self.stock) < self.idle + ahead else 0


class Dealing:
    """`seconds` of pings dealt to `ranks` of `threads` each, rank 0 included. `end`: when all are with rank 0;
    `lead_busy`: seconds that it spent on messages."""
    def __init__(self, seconds, ranks, threads, costs):
        self.seconds, self.next, self.costs, self.threads = seconds, 0, costs, threads
        self.events, self.count, self.now = [], 0, 0.0
        self.ranks = [Rank(threads, 0.0) for _ in range(ranks)]
        self.inbox, self.lead_busy, self.at_work, self.slept = collections.deque(), 0.0, False, 0.0
        self.finished, self.end = 0, 0.0
        self.at(0.0, self.lead_turn)
        for rank in self.ranks[1:]:
            self.at(0.0, self.turn, rank)
        while self.finished < len(seconds):
            self.now, _, what, arguments = heapq.heappop(self.events)
            what(*arguments)
        self.end = self.now

    def at(self, time, what, *arguments):
        self.count += 1
        heapq.heappush(self.events, (time, self.count, what, arguments))

    def deal(self, wanted):
        """Deal::next: no more than half of a fair part of what is left."""
        left = len(self.seconds) - self.next
        first, self.next = self.next, self.next + min(left, wanted, max(1, left // (2 * len(self.ranks))))
        return range(first, self.next)

    def add(self, rank, units):
        rank.closed = rank.closed or not units
        rank.stock.extend(units)
        self.begin_pings(rank)

    def begin_pings(self, rank):
        while rank.idle and rank.stock:
            rank.idle -= 1
            self.at(self.now + self.seconds[rank.stock.popleft()], self.ping_done, rank)

    def ping_done(self, rank):
        rank.idle += 1
        rank.done += 1
        self.begin_pings(rank)
        if rank is self.ranks[0]:
            self.finished += 1
            if not self.at_work:  # a finished ping wakes it
                self.lead_turn()
        else:
            rank.results += 1
            self.turn(rank)

    # --- a helping rank: results go one by one, each waits until rank 0 takes it
    def turn(self, rank):
        if rank.sending:
            return
        for units in rank.answers:
            self.add(rank, units)
            rank.asked = False
        rank.answers.clear()
        if rank.results:
            rank.results -= 1
            rank.sending = True
            self.send_to_lead("result", rank)
            return
        wanted = rank.wanted(self.now)
        if wanted and not rank.asked:
            rank.asked = True
            self.send_to_lead("request", rank, wanted)

    def answer(self, rank, units):
        rank.answers.append(units)
        self.turn(rank)

    # --- rank 0
    def send_to_lead(self, kind, rank, wanted=0):
        self.inbox.append((kind, rank, wanted))
        if not self.at_work:  # asleep: it looks once a millisecond
            self.at_work = True
            looks = self.slept + math.ceil((self.now - self.slept) / REST_S) * REST_S
            self.at(max(self.now, looks), self.lead_turn)

    def lead_turn(self):
        self.at_work = True
        if self.inbox:
            kind, rank, wanted = self.inbox.popleft()
            spent = self.costs.result if kind == "result" else self.costs.request
            self.lead_busy += spent
            self.at(self.now + spent, self.lead_done, kind, rank, wanted)
            return
        own = self.ranks[0]
        wanted = own.wanted(self.now)
        if wanted:
            self.add(own, self.deal(wanted))
        self.at_work, self.slept = False, self.now

    def lead_done(self, kind, rank, wanted):
        if kind == "result":
            self.finished += 1
            rank.sending = False
            self.turn(rank)
        else:  # half of its millisecond of rest, on average, until the rank looks
            self.at(self.now + REST_S / 2, self.answer, rank, self.deal(wanted))
        self.lead_turn()


def predict(seconds, ranks, threads, costs):
    """Where the seconds of a run go. They add up to its `total`."""
    dealing = Dealing(seconds, ranks, threads, costs)
    unhindered = Dealing(seconds, ranks, threads, costs.free_lead()).end if ranks > 1 else dealing.end
    shared = float(seconds.sum()) / (ranks * threads)
    parts = {"launch and load": costs.launch + costs.load, "pings": shared, "waiting and tail": unhindered - shared,
             "rank 0": dealing.end - unhindered, "writing": costs.write * len(seconds) + costs.finish}
    return {"parts": parts, "total": sum(parts.values()), "simulation": dealing.end,
            "lead_busy": dealing.lead_busy / dealing.end}
