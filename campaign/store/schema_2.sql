-- Version 2: the journal's number, what a seam and a loss are judged by, hangs, hosts and threads.

CREATE TABLE journal (
  id     INTEGER PRIMARY KEY CHECK (id = 1),
  number INTEGER NOT NULL
) STRICT;
INSERT INTO journal (id, number) VALUES (1, 0);

ALTER TABLE run ADD COLUMN engine_hash TEXT NOT NULL DEFAULT '';
ALTER TABLE attempt ADD COLUMN threads INTEGER NOT NULL DEFAULT 1;
ALTER TABLE attempt ADD COLUMN host TEXT NOT NULL DEFAULT '';
ALTER TABLE attempt ADD COLUMN progress_step INTEGER NOT NULL DEFAULT 0;
ALTER TABLE attempt ADD COLUMN progress_at REAL NOT NULL DEFAULT 0.0;
ALTER TABLE attempt ADD COLUMN slowest_checkpoint REAL NOT NULL DEFAULT 0.0;
ALTER TABLE attempt ADD COLUMN useful_seconds REAL NOT NULL DEFAULT 0.0;
ALTER TABLE attempt ADD COLUMN lost_seconds REAL NOT NULL DEFAULT 0.0;
ALTER TABLE attempt ADD COLUMN hung_seconds REAL NOT NULL DEFAULT 0.0;

CREATE INDEX attempt_by_end ON attempt (ended_at);

DROP VIEW v_attempts;
CREATE VIEW v_attempts AS
  SELECT a.id AS attempt_id, r.label AS run, c.position AS chunk, a.number, a.token, a.job, a.state,
         a.code, a.has_outcome, a.outcome_class, a.reason, a.host, a.created_at,
         nullif(a.submitted_at, 0.0) AS submitted_at, nullif(a.running_at, 0.0) AS running_at,
         nullif(a.ended_at, 0.0) AS ended_at, a.start_step, a.step, a.time AS time_s, a.steps_done,
         a.ranks, a.threads, a.wall_seconds, a.compute_seconds, a.checkpoint_seconds,
         a.useful_seconds, a.lost_seconds, a.hung_seconds, a.checkpoint, a.state_hash, a.engine_hash
  FROM attempt a JOIN run r ON r.id = a.run_id JOIN chunk c ON c.id = a.chunk_id
  ORDER BY a.run_id, a.number;

-- Where one attempt went on from another's state, and whether with another program or other ranks.
CREATE VIEW v_seams AS
  SELECT r.label AS run, a.number, a.start_step, b.engine_hash AS engine_hash_before,
         a.engine_hash, b.engine_hash <> a.engine_hash AS engine_changed,
         b.ranks AS ranks_before, a.ranks
  FROM attempt a
  JOIN attempt b ON b.run_id = a.run_id
       AND b.number = (SELECT max(p.number) FROM attempt p
                       WHERE p.run_id = a.run_id AND p.number < a.number AND p.running_at > 0)
  JOIN run r ON r.id = a.run_id
  WHERE a.start_step > 0 AND a.running_at > 0
  ORDER BY a.run_id, a.number;

-- Where the seconds went, per run. An attempt without an outcome occupied its job from the first
-- sight of it running to its end, both on the manager's clock.
DROP VIEW v_ledger;
CREATE VIEW v_ledger AS
  SELECT run_id, run, count(attempt_id) AS attempts,
         total(queued) AS queued_seconds,
         total(occupied) AS occupied_seconds,
         total(wall_seconds) AS wall_seconds,
         total(compute_seconds) AS compute_seconds,
         total(checkpoint_seconds) AS checkpoint_seconds,
         total(wall_seconds - compute_seconds - checkpoint_seconds) AS other_seconds,
         total(useful_seconds) AS useful_seconds,
         total(lost_seconds) AS lost_seconds,
         total(hung_seconds) AS hung_seconds,
         total(useful_seconds) / nullif(total(occupied), 0.0) AS goodput,
         total(occupied * ranks) AS rank_seconds,
         total(occupied * ranks * threads) AS core_seconds,
         coalesce(sum(steps_done), 0) AS steps_done
  FROM (SELECT r.id AS run_id, r.label AS run, a.id AS attempt_id, a.ranks, a.threads,
               a.wall_seconds, a.compute_seconds, a.checkpoint_seconds, a.useful_seconds, a.lost_seconds,
               a.hung_seconds, a.steps_done,
               CASE WHEN a.submitted_at > 0 AND a.running_at > 0
                    THEN max(a.running_at - a.submitted_at, 0.0) END AS queued,
               CASE WHEN a.has_outcome = 1 THEN a.wall_seconds
                    WHEN a.running_at > 0 AND a.ended_at > 0
                    THEN max(a.ended_at - a.running_at, 0.0) END AS occupied
        FROM run r LEFT JOIN attempt a ON a.run_id = r.id)
  GROUP BY run_id ORDER BY run_id;

-- What was lost, by cause.
CREATE VIEW v_losses AS
  SELECT r.label AS run, a.outcome_class, count(*) AS attempts,
         total(a.lost_seconds) AS lost_seconds, total(a.hung_seconds) AS hung_seconds
  FROM attempt a JOIN run r ON r.id = a.run_id
  WHERE a.lost_seconds > 0 OR a.hung_seconds > 0
  GROUP BY a.run_id, a.outcome_class ORDER BY a.run_id, a.outcome_class;
