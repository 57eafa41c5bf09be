// SPDX-License-Identifier: BSD-3-Clause
"use strict";
// The token, if there is one, comes behind # and so never reaches a log.
const token = new URLSearchParams(location.hash.slice(1)).get("token") || "";
const wants = new URLSearchParams(location.search);
const $ = id => document.getElementById(id);
const kRowsMost = 500;
let campaign = wants.get("campaign") || "", chosen = wants.get("run") || "";
let status = { runs: [] }, change = null, stream = null;

const headers = token ? { Authorization: "Bearer " + token } : {};
const query = more => new URLSearchParams({ campaign, ...more });

async function ask(what, more = {}) {
  const answer = await fetch(`/api/${what}?${query(more)}`, { headers });
  const json = await answer.json();
  if (!answer.ok) throw new Error(json.error || answer.statusText);
  return json;
}

function say(text) {
  $("message").textContent = text;
  $("message").hidden = !text;
}

const guarded = work => async (...words) => {
  try { await work(...words); } catch (error) { say(error.message); }
};

function make(parent, tag, text = "", attributes = {}) {
  const isSvg = parent instanceof SVGElement;
  const one = isSvg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) one.setAttribute(name, value);
  if (text !== "") one.textContent = text;
  parent.append(one);
  return one;
}

const kinds = { COMPLETED: "good", STEADY: "good", CHUNK_DONE: "good", RUNNING: "busy", QUEUED: "busy",
  SUBMITTING: "busy", READY: "wait", PLANNED: "wait", UNKNOWN: "wait", HELD: "bad", FAILED: "bad", CANCELLED: "bad" };
const isDone = run => run.state === "COMPLETED" || run.state === "STEADY";
const shareOf = run => isDone(run) ? 1 : run.end_time_s ? Math.min(run.time_s / run.end_time_s, 1) : 0;

function duration(seconds) {
  if (!(seconds >= 0)) return "";
  const s = Math.round(seconds), two = n => String(n).padStart(2, "0");
  if (s < 60) return `${s}s`;
  if (s < 3600) return `${Math.floor(s / 60)}m ${two(s % 60)}s`;
  return s < 86400 ? `${Math.floor(s / 3600)}h ${two(Math.floor(s / 60) % 60)}m` : `${Math.floor(s / 86400)}d ${two(Math.floor(s / 3600) % 24)}h`;
}

function showCounts(counts) {
  $("counts").replaceChildren();
  for (const [state, count] of Object.entries(counts)) make($("counts"), "span", `${count} ${state}  `, { class: kinds[state] || "" });
}

function showRuns() {
  const words = $("filter").value.toLowerCase();
  const runs = status.runs.filter(run => `${run.label} ${run.state}`.toLowerCase().includes(words));
  $("runs").replaceChildren();
  for (const run of runs.slice(0, kRowsMost)) {
    const row = make($("runs"), "tr", "", { tabindex: "0", "data-run": run.label, class: run.label === chosen ? "chosen" : "" });
    make(row, "td", run.label);
    make(row, "td", run.state, { class: kinds[run.state] || "" });
    const cell = make(row, "td", "", { title: `${run.time_s} s` + (run.end_time_s ? ` of ${run.end_time_s} s` : "") });
    make(make(cell, "div", "", { class: "bar" }), "div").style.width = `${100 * shareOf(run)}%`;
    make(row, "td", `${run.chunks_done}/${run.chunks}`);
    make(row, "td", run.progress ? duration(run.progress.seconds_left) : "");
    make(row, "td", run.reason);
    row.addEventListener("click", () => choose(run.label));
    row.addEventListener("keydown", event => { if (event.key === "Enter") choose(run.label); });
  }
  $("more").textContent = runs.length > kRowsMost ? `${runs.length - kRowsMost} more: filter` : "";
  const whole = status.runs.reduce((sum, run) => sum + shareOf(run), 0) / Math.max(status.runs.length, 1);
  $("whole").firstElementChild.style.width = `${100 * whole}%`;
  showCounts(status.counts || {});
}

const box = { left: 52, right: 470, top: 10, bottom: 244 };

// Round numbers within [low, high], about five.
function ticks([low, high]) {
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(n => n * power).find(n => n >= rough), all = [];
  for (let i = Math.ceil(low / step); i * step <= high; ++i) all.push(i * step);
  return all;
}

function axes(svg, x, y, xName, yName) {
  svg.replaceChildren();
  const X = v => box.left + (v - x[0]) / (x[1] - x[0]) * (box.right - box.left);
  const Y = v => box.bottom - (v - y[0]) / (y[1] - y[0]) * (box.bottom - box.top);
  for (const v of ticks(y)) {
    make(svg, "line", "", { class: "axis", x1: box.left, x2: box.right, y1: Y(v), y2: Y(v) });
    make(svg, "text", +v.toPrecision(6), { x: box.left - 6, y: Y(v) + 4, "text-anchor": "end" });
  }
  for (const v of ticks(x)) make(svg, "text", +v.toPrecision(6), { x: X(v), y: box.bottom + 14, "text-anchor": "middle" });
  make(svg, "text", xName, { x: (box.left + box.right) / 2, y: 276, "text-anchor": "middle" });
  make(svg, "text", yName, { x: 12, y: 130, "text-anchor": "middle", transform: "rotate(-90 12 130)" });
  return [X, Y];
}

function span(values) {
  let low = Math.min(...values), high = Math.max(...values);
  if (!(high > low)) { low -= 1; high += 1; }
  const room = 0.06 * (high - low);
  return [low - room, high + room];
}

function nothing(svg, text) {
  svg.replaceChildren();
  make(svg, "text", text, { x: 240, y: 130, "text-anchor": "middle" });
}

function showPoints(points) {
  const there = points.filter(p => p.slip.mean !== null && p.pull_coefficient.mean !== null);
  if (!there.length) return nothing($("slip"), "no run has driven yet");
  const [X, Y] = axes($("slip"), span(there.map(p => 100 * p.slip.mean)), span(there.map(p => 100 * p.pull_coefficient.mean)), "slip, %", "pull / load, %");
  for (const p of there) {
    const x = X(100 * p.slip.mean), y = 100 * p.pull_coefficient.mean, e = 200 * (p.pull_coefficient.error || 0);
    make($("slip"), "line", "", { class: "error", x1: x, x2: x, y1: Y(y - e), y2: Y(y + e) });
    const circle = make($("slip"), "circle", "", { class: p.is_complete ? "point" : "point open", cx: x, cy: Y(y), r: 4, "data-point": p.label });
    make(circle, "title", `${p.label}: ${y.toFixed(1)} % at ${(100 * p.slip.mean).toFixed(1)} % slip, ${p.state}`);
  }
}

function showPull(series) {
  const { travel_m: x, pull: y } = series.columns;
  const rows = x.map((v, i) => [v, y[i]]).filter(row => row[0] !== null && row[1] !== null);
  if (rows.length < 2) return nothing($("pull"), "nothing was recorded yet");
  const [X, Y] = axes($("pull"), span(rows.map(r => r[0])), span(rows.map(r => r[1])), "travel, m", "drawbar pull, N");
  make($("pull"), "path", "", { class: "curve", "data-rows": rows.length, d: "M" + rows.map(r => `${X(r[0]).toFixed(1)} ${Y(r[1]).toFixed(1)}`).join("L") });
}

function showTimeline(attempts) {
  const svg = $("timeline");
  const rows = attempts.filter(a => a.submitted_at).slice(-400);
  if (!rows.length) return nothing(svg, "no job was submitted yet");
  const now = Date.now() / 1000, from = Math.min(...rows.map(a => a.submitted_at));
  const to = Math.max(...rows.map(a => a.ended_at || now), from + 1);
  const names = [...new Set(rows.map(a => a.run))].slice(-24);
  svg.replaceChildren();
  const X = t => 120 + (t - from) / (to - from) * 350, high = Math.min(18, 250 / names.length);
  names.forEach((name, i) => make(svg, "text", name.slice(0, 18), { x: 114, y: 10 + high * (i + 0.7), "text-anchor": "end" }));
  for (const a of rows) {
    const at = names.indexOf(a.run);
    if (at < 0) continue;
    const draw = (kind, begin, end) => {
      const bar = make(svg, "rect", "", { class: kind, x: X(begin), y: 11 + high * at, width: Math.max(X(end) - X(begin), 0.5), height: high - 2 });
      make(bar, "title", `${a.run}, attempt ${a.number}: ${a.state} ${a.reason}`);
    };
    const end = a.ended_at || now;
    draw("queued", a.submitted_at, a.running_at || end);
    if (a.running_at) draw(!a.ended_at ? "running" : a.state === "FAILED" ? "failed" : "done", a.running_at, end);
  }
  make(svg, "text", new Date(1000 * from).toLocaleString(), { x: 120, y: 275 });
  make(svg, "text", new Date(1000 * to).toLocaleString(), { x: 470, y: 275, "text-anchor": "end" });
}

function showLedger(rows) {
  const sum = key => rows.reduce((total, row) => total + (row[key] || 0), 0);
  const parts = [["useful", sum("useful_seconds")], ["checkpoints", sum("checkpoint_seconds")], ["starting, other", sum("other_seconds")],
    ["lost", sum("lost_seconds")], ["hung", sum("hung_seconds")]];
  const all = parts.reduce((total, part) => total + part[1], 0);
  $("ledger").replaceChildren();
  if (!(all > 0)) return make($("ledger"), "p", "nothing was computed yet", { class: "quiet" });
  const bar = make($("ledger"), "div", "", { class: "share" }), list = make($("ledger"), "dl");
  parts.forEach(([name, seconds], i) => {
    make(bar, "span", "", { class: `s${i}`, title: name }).style.width = `${100 * seconds / all}%`;
    const term = make(list, "dt");
    make(term, "i", "", { class: `s${i}` });
    term.append(name);
    make(list, "dd", duration(seconds));
    make(list, "dd", `${(100 * seconds / all).toFixed(1)} %`);
  });
  const occupied = sum("occupied_seconds");
  if (occupied > 0) make($("ledger"), "p", `goodput ${(100 * sum("useful_seconds") / occupied).toFixed(1)} %: computing that is in the runs' states, of all the time jobs were at work`, { id: "goodput" });
}

const loadRun = guarded(async () => {
  $("chosen").textContent = $("log-of").textContent = chosen || "no run";
  if (!chosen) return;
  showPull(await ask("series", { run: chosen }));
  const run = status.runs.find(one => one.label === chosen);
  if (!run || !run.attempts) { $("log").textContent = "no attempt yet"; return; }
  const [log] = (await ask("logs", { run: chosen, tail: 200 })).logs;
  $("log").textContent = log.text === null ? "nothing was written yet" : log.text;
  $("log").scrollTop = $("log").scrollHeight;
});

function choose(label) {
  chosen = label;
  showRuns();
  loadRun();
}

const loadAll = guarded(async () => {
  status = await ask("status");
  document.title = `${status.campaign} - grouser`;
  $("title").textContent = status.title || status.campaign;
  if (!status.runs.some(run => run.label === chosen))
    chosen = (status.runs.find(run => run.state === "RUNNING" && run.kind === "wheel") || status.runs.find(run => run.kind === "wheel") || status.runs[0] || { label: "" }).label;
  say("");
  showRuns();
  showTimeline((await ask("table", { view: "v_attempts", limit: 5000 })).rows);
  showLedger((await ask("table", { view: "v_ledger", limit: 100000 })).rows);
  await loadRun();
  if (status.runs.length <= kRowsMost) showPoints((await ask("points")).points);
  else nothing($("slip"), "too many runs: see the report");
  document.body.dataset.loaded = "yes";
});

function onStatus(beat) {
  const isNew = change !== null && beat.change !== change;
  change = beat.change;
  document.body.dataset.beats = Number(document.body.dataset.beats || 0) + 1;
  showCounts(beat.counts);
  for (const one of beat.active) {
    const run = status.runs.find(other => other.label === one.label);
    if (!run) continue;
    Object.assign(run, { time_s: one.time_s, end_time_s: one.end_time_s, progress: one });
  }
  if (isNew) loadAll();
  else { showRuns(); if (beat.active.some(one => one.label === chosen)) loadRun(); }
}

// Read by hand, because an EventSource cannot carry the token.
async function follow() {
  if (stream) stream.abort();
  const mine = stream = new AbortController();
  while (!mine.signal.aborted) {
    try {
      const answer = await fetch(`/api/events?${query({})}`, { headers, signal: mine.signal });
      if (!answer.ok) throw new Error("refused");
      $("live").textContent = "live";
      $("live").className = "on";
      const reader = answer.body.pipeThrough(new TextDecoderStream()).getReader();
      for (let text = "";;) {
        const { value, done } = await reader.read();
        if (done) break;
        text += value;
        const messages = text.split("\n\n");
        text = messages.pop();
        for (const message of messages) {
          const data = message.split("\n").find(line => line.startsWith("data: "));
          if (data) onStatus(JSON.parse(data.slice(6)));
        }
      }
    } catch (error) { if (mine.signal.aborted) return; }
    $("live").textContent = "not live";
    $("live").className = "off";
    await new Promise(go => setTimeout(go, 3000));
  }
}

const open = guarded(async key => {
  campaign = key;
  change = null;
  $("report").href = `/report?${query({})}`;
  await loadAll();
  if (wants.get("live") !== "0") follow();
});

const act = guarded(async verb => {
  if (verb === "cancel" && !confirm(`Kill the job of ${chosen}? Work since its last checkpoint is lost.`)) return;
  const answer = await fetch(`/api/${verb}?${query(verb === "tick" ? {} : { run: chosen })}`, { method: "POST", headers });
  const json = await answer.json();
  await loadAll();
  say(answer.ok ? json.done : json.error);
});

guarded(async () => {
  const list = await ask("campaigns");
  for (const one of list.campaigns) make($("campaigns"), "option", one.key, { value: one.key });
  $("campaigns").addEventListener("change", () => { chosen = ""; open($("campaigns").value); });
  $("filter").addEventListener("input", showRuns);
  $("actions").hidden = !(list.may_write && token);
  for (const button of document.querySelectorAll("button[data-verb]")) button.addEventListener("click", () => act(button.dataset.verb));
  if (campaign) $("campaigns").value = campaign;
  await open($("campaigns").value);
})();
