// The page: the design on the left (drawing and fields, or TOML), the stage or a tool in the middle, the result on the right.

import { useSignal } from "@preact/signals";
import type { ComponentChild, ComponentChildren } from "preact";
import { useEffect, useRef } from "preact/hooks";

import { Section } from "./drawing/section.tsx";
import { AnglesPanel } from "./panels/angles.tsx";
import { ComparePanel } from "./panels/compare.tsx";
import { rowsOf } from "./model/csv.ts";
import { toolOf } from "./model/tools.ts";
import { ConePanel } from "./panels/cone.tsx";
import { DetailPanel } from "./panels/detail.tsx";
import { ToolCommand } from "./panels/command.tsx";
import { applyWidths, Divider, widths } from "./panels/divider.tsx";
import { Downloads } from "./panels/downloads.tsx";
import { JobsPanel } from "./panels/jobs.tsx";
import { FieldsPanel, Room, Toolbar } from "./panels/editor.tsx";
import { FitPanel } from "./panels/fit.tsx";
import { FilesPanel } from "./panels/files.tsx";
import { Gallery, NewDisplay } from "./panels/gallery.tsx";
import { ImagePanel } from "./panels/image.tsx";
import { Header } from "./panels/header.tsx";
import { LedgerPanel } from "./panels/ledger.tsx";
import { OptimizePanel } from "./panels/optimize.tsx";
import { PixelPanel } from "./panels/pixel.tsx";
import { Problems } from "./panels/problems.tsx";
import { Readability } from "./panels/readability.tsx";
import { RoomsPanel } from "./panels/rooms.tsx";
import { SidePanel } from "./panels/side.tsx";
import { CommandsPanel, SharePanel } from "./panels/share.tsx";
import { Stage } from "./panels/stage.tsx";
import { Source } from "./panels/source.tsx";
import { Aged, ContentContext, AgeMark, liveClass } from "./panels/aged.tsx";
import { SurfacePanel } from "./panels/surface.tsx";
import { Summary } from "./panels/summary.tsx";
import { Spoken } from "./panels/spoken.tsx";
import { StatesTable } from "./panels/table.tsx";
import { Notes } from "./panels/notes.tsx";
import { SweepPanel } from "./panels/sweep.tsx";
import { Tabs } from "./panels/tabs.tsx";
import { TolerancePanel } from "./panels/tolerance.tsx";
import { ValidatePanel } from "./panels/validate.tsx";
import { Versions } from "./panels/versions.tsx";
import { Views } from "./panels/views.tsx";
import { WalkPanel } from "./panels/walk.tsx";
import { Welcome } from "./panels/welcome.tsx";
import { Chromaticity } from "./plots/chromaticity.tsx";
import { Patches } from "./plots/patches.tsx";
import { Spectra } from "./plots/spectra.tsx";
import { answer, busy, draft, opening, problems, resultCount, startProblems, text } from "./state/design.ts";
import { firstError, liveAge } from "./state/age.ts";
import { compact, part, type Part } from "./state/compact.ts";
import { discard } from "./state/live.ts";
import { openStep, openTab, showTab } from "./state/tab.ts";

function Design() {
  const source = useSignal(false);
  return (
    <section class="design" aria-label="Design" inert={opening.value !== ""}>
      <div class="switch" role="group" aria-label="View of the design">
        <button type="button" aria-pressed={!source.value} onClick={() => (source.value = false)}>
          Drawing
        </button>
        <button type="button" aria-pressed={source.value} onClick={() => (source.value = true)}>
          TOML
        </button>
        <Room />
      </div>
      {source.value ? (
        <Source />
      ) : (
        <>
          <Section />
          <Toolbar />
          <FieldsPanel />
        </>
      )}
    </section>
  );
}

/** A part of the live result. */
function OfResult({ children }: { children: ComponentChildren }) {
  return <Aged age={liveAge.value} count={resultCount.value}>{children}</Aged>;
}

/** The readability, which can be saved as it is shown. */
function Reading() {
  const shown = () => rowsOf(document.querySelector("#tab-panel table"));
  return (
    <OfResult>
      <Readability />
      <p class="figure-tools">
        <Downloads name="readability" table={shown} />
      </p>
    </OfResult>
  );
}

/** A diagram of the result at full height. */
function Enlarged({ children }: { children: ComponentChildren }) {
  return (
    <ContentContext.Provider value={{ age: liveAge.value }}>
      <div class={`plots enlarged${liveClass()}`}>{children}</div>
    </ContentContext.Provider>
  );
}

/** Commands of the tools that start jobs. */
const DIFFUSER = ["fit", "inspect", "convert", "calibrate", "steps", "measure"].map((name) => `diffuser ${name}`);
const STUDY = ["study sampling"];
const BRDF = ["brdf"];

/** What each tool shows. */
const BODIES: Readonly<Record<string, () => ComponentChild>> = {
  examples: () => <Gallery />,
  new: () => <NewDisplay />,
  files: () => <FilesPanel />,
  stage: () => <Stage />,
  side: () => <SidePanel />,
  states: () => <OfResult><StatesTable /></OfResult>,
  spectra: () => <Enlarged><Spectra /></Enlarged>,
  chromaticity: () => <Enlarged><Chromaticity /></Enlarged>,
  energy: () => <OfResult><LedgerPanel /></OfResult>,
  surface: () => <SurfacePanel />,
  image: () => <ImagePanel />,
  rooms: () => <RoomsPanel />,
  angles: () => <AnglesPanel />,
  cone: () => <ConePanel />,
  detail: () => <DetailPanel />,
  reading: () => <Reading />,
  pixel: () => <PixelPanel />,
  walk: () => <WalkPanel />,
  compare: () => <ComparePanel />,
  validate: () => <ValidatePanel />,
  sweep: () => <SweepPanel />,
  optimize: () => <OptimizePanel />,
  tolerance: () => <TolerancePanel />,
  fit: () => <FitPanel />,
  diffuser: () => <JobsPanel key="diffuser" names={DIFFUSER} />,
  study: () => <JobsPanel key="study" names={STUDY} />,
  brdf: () => <JobsPanel key="brdf" names={BRDF} />,
  jobs: () => <JobsPanel key="jobs" />,
  export: () => <SharePanel />,
  commands: () => <CommandsPanel />,
};

/** The middle column: the stage, or a tool of the open step. */
function Middle() {
  const { id, name, tools } = openStep.value;
  const tabs = tools.map((tool) => ({ ...tool, body: BODIES[tool.id]! }));
  return (
    <main class="middle" aria-label="Stage and tools" data-tool={openTab.value}>
      <Divider side="left" />
      <Divider side="right" />
      <Tabs key={id} tabs={tabs} open={openTab} name={name} show={showTab} />
      <ToolCommand id={openTab.value} />
      <Versions />
    </main>
  );
}

/** The first place of the result, at its top: the numbers and the states. */
function First() {
  return (
    <div class={`first${liveClass()}`}>
      <div class="top">
        <span class="seen-from">
          <AgeMark age={liveAge.value} count={resultCount.value} more={firstError.value} />
          <Views />
        </span>
        <Summary />
      </div>
      <Patches />
    </div>
  );
}

/** A diagram that a click enlarges. */
function Small({ tool, children }: { tool: string; children: ComponentChildren }) {
  const isOpen = openTab.value === tool;
  const { name } = toolOf(tool);
  return (
    <div class="small-plot">
      {children}
      <button
        type="button"
        class="enlarge"
        aria-pressed={isOpen}
        aria-label={`Enlarge: ${name}`}
        title="Enlarge"
        onClick={() => showTab(isOpen ? "stage" : tool)}
      >
        ⤢
      </button>
    </div>
  );
}

function ResultPanel() {
  return (
    <aside
      id="result"
      tabindex={-1}
      class={`picture${busy.value ? " busy" : ""}${opening.value ? " opening" : ""}`}
      aria-busy={busy.value}
      aria-label="Result"
    >
      <First />
      <ContentContext.Provider value={{ age: liveAge.value }}>
        <div class={`plots${liveClass()}`}>
          <Small tool="chromaticity">
            <Chromaticity />
          </Small>
          <Small tool="spectra">
            <Spectra />
          </Small>
        </div>
      </ContentContext.Provider>
      <Notes />
      <Spoken />
    </aside>
  );
}

const PARTS: readonly (readonly [Part, string])[] = [
  ["details", "Stage and tools"],
  ["design", "Layers and light"],
  ["plots", "Diagrams"],
];

/** The choice of the section in the compact layout. */
function Sections() {
  return (
    <div class="sections" role="group" aria-label="Section of the page">
      {PARTS.map(([id, name]) => (
        <button type="button" key={id} aria-pressed={part.value === id} onClick={() => (part.value = id)}>
          {name}
        </button>
      ))}
    </div>
  );
}

/** The text of a scenario that cannot be computed, if there is no earlier result to show. */
function Broken() {
  return (
    <main class="broken" aria-label="Scenario with errors">
      <h2>This scenario cannot be computed</h2>
      <Source />
      {text.value !== "" && draft.value !== null && (
        <button type="button" onClick={discard}>
          Back to the previous design
        </button>
      )}
    </main>
  );
}

/** The page before the first result; or the reason why there is none: no server, or no token. */
function Starting() {
  if (startProblems.value.length === 0)
    return (
      <p class="starting" role="status">
        Computing…
      </p>
    );
  return (
    <main class="broken" aria-label="Papilio cannot start">
      <h2>Papilio cannot start</h2>
      <Problems of={startProblems.value} />
    </main>
  );
}

/** The three columns, with movable borders. */
function Bench() {
  const bench = useRef<HTMLDivElement>(null);
  useEffect(() => applyWidths(bench.current), [widths.value]);
  return (
    <div class="bench" data-part={part.value} data-step={openStep.value.id} ref={bench}>
      <Design />
      <Middle />
      <ResultPanel />
      {compact.value && <Sections />}
    </div>
  );
}

export function App() {
  return (
    <>
      <Header />
      <Welcome />
      {answer.value && (
        <Bench />
      )}
      {!answer.value && (problems.value.length > 0 ? <Broken /> : <Starting />)}
    </>
  );
}
