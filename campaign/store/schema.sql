-- Schema of grouser.db, version 1. Tables are the program's own and change with its version;
-- the views at the end are the documented interface (docs/reference/sql_views.md).
-- Times are seconds since 1970 on the manager's clock; simulated times are seconds.

CREATE TABLE campaign (
  id         INTEGER PRIMARY KEY CHECK (id = 1),
  name       TEXT NOT NULL,
  title      TEXT NOT NULL,
  source     TEXT NOT NULL,
  settings   TEXT NOT NULL,
  engine     TEXT NOT NULL,
  created_at REAL NOT NULL
) STRICT;

CREATE TABLE lease (
  id    INTEGER PRIMARY KEY CHECK (id = 1),
  host  TEXT NOT NULL,
  boot  TEXT NOT NULL,
  pid   INTEGER NOT NULL,
  start INTEGER NOT NULL,
  beat  INTEGER NOT NULL
) STRICT;

CREATE TABLE run (
  id           INTEGER PRIMARY KEY,
  label        TEXT NOT NULL UNIQUE,
  kind         TEXT NOT NULL CHECK (kind IN ('bed', 'wheel')),
  directory    TEXT NOT NULL UNIQUE,
  key          TEXT NOT NULL,
  in_plan      INTEGER NOT NULL CHECK (in_plan IN (0, 1)),
  bed_id       INTEGER REFERENCES run (id),
  state        TEXT NOT NULL,
  reason       TEXT NOT NULL,
  request      TEXT NOT NULL CHECK (request IN ('', 'stop', 'cancel')),
  requested_at REAL NOT NULL,
  failures     INTEGER NOT NULL,
  not_before   REAL NOT NULL,
  step         INTEGER NOT NULL,
  time         REAL NOT NULL,
  end_time     REAL NOT NULL,
  checkpoint   TEXT NOT NULL,
  state_hash   TEXT NOT NULL,
  particles    INTEGER NOT NULL
) STRICT;
CREATE INDEX run_by_bed ON run (bed_id);

CREATE TABLE run_axis (
  run_id   INTEGER NOT NULL REFERENCES run (id),
  position INTEGER NOT NULL,
  axis     TEXT NOT NULL,
  label    TEXT NOT NULL,
  PRIMARY KEY (run_id, position)
) STRICT, WITHOUT ROWID;

CREATE TABLE chunk (
  id         INTEGER PRIMARY KEY,
  run_id     INTEGER NOT NULL REFERENCES run (id),
  position   INTEGER NOT NULL,
  until_time REAL,
  state      TEXT NOT NULL,
  step       INTEGER NOT NULL,
  time       REAL NOT NULL,
  UNIQUE (run_id, position)
) STRICT;

CREATE TABLE attempt (
  id                 INTEGER PRIMARY KEY,
  run_id             INTEGER NOT NULL REFERENCES run (id),
  chunk_id           INTEGER NOT NULL REFERENCES chunk (id),
  number             INTEGER NOT NULL,
  token              TEXT NOT NULL UNIQUE,
  job                TEXT NOT NULL,
  state              TEXT NOT NULL,
  code               INTEGER,
  has_outcome        INTEGER NOT NULL,
  outcome_class      TEXT NOT NULL,
  reason             TEXT NOT NULL,
  created_at         REAL NOT NULL,
  submitted_at       REAL NOT NULL,
  running_at         REAL NOT NULL,
  outcome_at         REAL NOT NULL,
  ended_at           REAL NOT NULL,
  start_step         INTEGER NOT NULL,
  step               INTEGER NOT NULL,
  time               REAL NOT NULL,
  steps_done         INTEGER NOT NULL,
  particles          INTEGER NOT NULL,
  ranks              INTEGER NOT NULL,
  wall_seconds       REAL NOT NULL,
  compute_seconds    REAL NOT NULL,
  checkpoint_seconds REAL NOT NULL,
  checkpoint         TEXT NOT NULL,
  state_hash         TEXT NOT NULL,
  engine_hash        TEXT NOT NULL,
  absences           INTEGER NOT NULL,
  absent_since       REAL NOT NULL,
  absent_step        INTEGER NOT NULL,
  UNIQUE (run_id, number)
) STRICT;
CREATE INDEX attempt_by_chunk ON attempt (chunk_id);

-- The rule the whole manager stands on: a run never has two attempts for which a job may exist.
CREATE UNIQUE INDEX one_active_attempt ON attempt (run_id)
  WHERE state IN ('SUBMITTING', 'QUEUED', 'RUNNING', 'UNKNOWN');

CREATE VIEW v_status AS
  SELECT kind, state, count(*) AS runs FROM run GROUP BY kind, state;

CREATE VIEW v_runs AS
  SELECT r.id AS run_id, r.label, r.kind, r.state, r.reason, r.directory, r.key,
         b.label AS bed, r.step, r.time AS time_s,
         nullif(r.end_time, 0.0) AS end_time_s,
         (SELECT count(*) FROM chunk c WHERE c.run_id = r.id) AS chunks,
         (SELECT count(*) FROM attempt a WHERE a.run_id = r.id) AS attempts,
         r.failures, r.checkpoint, r.state_hash, nullif(r.particles, 0) AS particles,
         r.in_plan
  FROM run r LEFT JOIN run b ON b.id = r.bed_id
  ORDER BY r.id;

CREATE VIEW v_axes AS
  SELECT r.id AS run_id, r.label AS run, a.position, a.axis, a.label AS point
  FROM run_axis a JOIN run r ON r.id = a.run_id
  ORDER BY r.id, a.position;

CREATE VIEW v_chunks AS
  SELECT c.id AS chunk_id, r.label AS run, c.position, c.state, c.until_time AS until_time_s,
         c.step, c.time AS time_s,
         (SELECT count(*) FROM attempt a WHERE a.chunk_id = c.id) AS attempts
  FROM chunk c JOIN run r ON r.id = c.run_id
  ORDER BY c.run_id, c.position;

CREATE VIEW v_attempts AS
  SELECT a.id AS attempt_id, r.label AS run, c.position AS chunk, a.number, a.token, a.job, a.state,
         a.code, a.has_outcome, a.outcome_class, a.reason, a.created_at,
         nullif(a.submitted_at, 0.0) AS submitted_at, nullif(a.running_at, 0.0) AS running_at,
         nullif(a.ended_at, 0.0) AS ended_at, a.start_step, a.step, a.time AS time_s, a.steps_done,
         a.ranks, a.wall_seconds, a.compute_seconds, a.checkpoint_seconds, a.checkpoint,
         a.state_hash, a.engine_hash
  FROM attempt a JOIN run r ON r.id = a.run_id JOIN chunk c ON c.id = a.chunk_id
  ORDER BY a.run_id, a.number;

-- Where the seconds went, per run. Attempts without an outcome count as lost from their start
-- to their end as the manager saw them.
CREATE VIEW v_ledger AS
  SELECT r.id AS run_id, r.label AS run, count(a.id) AS attempts,
         total(CASE WHEN a.submitted_at > 0 AND a.running_at > 0
                    THEN max(a.running_at - a.submitted_at, 0.0) END) AS queued_seconds,
         total(a.wall_seconds) AS wall_seconds,
         total(a.compute_seconds) AS compute_seconds,
         total(a.checkpoint_seconds) AS checkpoint_seconds,
         total(a.wall_seconds - a.compute_seconds - a.checkpoint_seconds) AS other_seconds,
         total(CASE WHEN a.has_outcome = 0 AND a.running_at > 0 AND a.ended_at > 0
                    THEN a.ended_at - a.running_at END) AS lost_seconds,
         total(a.wall_seconds * a.ranks) AS rank_seconds,
         coalesce(sum(a.steps_done), 0) AS steps_done
  FROM run r LEFT JOIN attempt a ON a.run_id = r.id
  GROUP BY r.id ORDER BY r.id;
