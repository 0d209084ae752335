-- The store of a study's data, version 1. Times are UTC milliseconds. `seq` counts through events, answers and exposures
-- together: in its order they are all that happened, and sessions and places are rebuilt from them.

CREATE TABLE study (
    version   INTEGER PRIMARY KEY,
    id        TEXT NOT NULL,
    hash      TEXT NOT NULL UNIQUE,   -- SHA-256 of study file, texts and libraries
    file      TEXT NOT NULL,          -- the study file
    materials TEXT NOT NULL,          -- names of gaits by library, texts by file: JSON
    program   TEXT NOT NULL,          -- version of the program that opened it
    opened    INTEGER NOT NULL
) STRICT;

-- One row.
CREATE TABLE secret (
    one       INTEGER PRIMARY KEY CHECK (one = 1),
    names     INTEGER NOT NULL,       -- what names of stimuli are made from
    ids       BLOB NOT NULL,          -- key of the hashes of platform ids
    is_closed INTEGER NOT NULL,       -- whether the operator has closed admission
    rows_from INTEGER, rows_to INTEGER  -- rows of the longest design that are given here; null: all
) STRICT;

CREATE TABLE participant (
    id            INTEGER PRIMARY KEY,
    version       INTEGER NOT NULL REFERENCES study,
    code          TEXT NOT NULL UNIQUE,
    external_hash BLOB UNIQUE,        -- keyed hash of the platform's id
    front         TEXT NOT NULL,      -- web, headset or simulated
    language      TEXT NOT NULL,
    person        INTEGER NOT NULL,   -- bits by which the plan draws
    arrived       INTEGER NOT NULL,
    state         TEXT NOT NULL,      -- where the participation stands; follows from the events
    changed       INTEGER NOT NULL    -- when the state last changed
) STRICT;

-- What a browser shows to be who it is. Only hashes are kept.
CREATE TABLE token (
    hash        BLOB PRIMARY KEY,
    participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE
) STRICT, WITHOUT ROWID;

-- Keyed hashes of platform ids whose participants withdrew and leave nothing that leads to them.
CREATE TABLE gone (
    external_hash BLOB PRIMARY KEY
) STRICT, WITHOUT ROWID;

-- Written when the place is given. Later swaps of stimuli are events.
CREATE TABLE trial (
    participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
    part        TEXT NOT NULL,
    position    INTEGER NOT NULL,
    item        INTEGER,              -- index of the stimulus in its part
    gait        TEXT, scene TEXT, condition TEXT, emotion TEXT, body TEXT,   -- what that stimulus is
    block       INTEGER,
    row         INTEGER,              -- of the design
    seed        INTEGER NOT NULL,
    role        TEXT NOT NULL,        -- ordinary, repeat or catch
    again       INTEGER,              -- of a repeat: position of the first showing
    wanted      INTEGER,              -- of a catch: the answer that is asked for
    UNIQUE (participant, part, position)
) STRICT;

CREATE TABLE exposure (
    seq             INTEGER PRIMARY KEY,
    participant     INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
    page            TEXT NOT NULL,
    at              INTEGER NOT NULL,
    started         INTEGER NOT NULL,
    seconds_visible REAL NOT NULL,
    plays           INTEGER NOT NULL,
    frames          INTEGER NOT NULL,
    late_frames     INTEGER NOT NULL,
    longest_ms      REAL NOT NULL
) STRICT;

-- All that were given; the last one to a question on a page counts.
CREATE TABLE answer (
    seq         INTEGER PRIMARY KEY,
    participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
    page        TEXT NOT NULL,
    question    TEXT NOT NULL,
    value       INTEGER,
    text        TEXT,
    first_ms    INTEGER NOT NULL,
    ms          INTEGER NOT NULL,
    key         TEXT NOT NULL,        -- made by the client: sent twice, it counts once
    at          INTEGER NOT NULL,
    UNIQUE (participant, page, question, key)
) STRICT;

CREATE TABLE event (
    seq         INTEGER PRIMARY KEY,
    participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
    at          INTEGER NOT NULL,
    kind        TEXT NOT NULL,
    detail      TEXT NOT NULL         -- JSON
) STRICT;

CREATE INDEX event_of ON event (participant);
CREATE INDEX exposure_of ON exposure (participant);
CREATE INDEX token_of ON token (participant);

CREATE TABLE operator (
    name TEXT PRIMARY KEY,
    hash TEXT NOT NULL,               -- argon2id
    role TEXT NOT NULL                -- watch, run or own
) STRICT, WITHOUT ROWID;

CREATE TABLE audit (
    at       INTEGER NOT NULL,
    operator TEXT NOT NULL,
    what     TEXT NOT NULL,
    about    TEXT NOT NULL            -- code of a participant, name of an operator, or empty
) STRICT;

-- What operators note about participants.
CREATE TABLE note (
    participant INTEGER NOT NULL REFERENCES participant ON DELETE CASCADE,
    at          INTEGER NOT NULL,
    operator    TEXT NOT NULL,
    text        TEXT NOT NULL
) STRICT;

-- What the health check writes and reads.
CREATE TABLE health (
    one INTEGER PRIMARY KEY CHECK (one = 1),
    at  INTEGER NOT NULL
) STRICT;

PRAGMA user_version = 1;
