// The page: the design on the left (drawing and fields, or TOML), the result on the right.

import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";

import { Section } from "./drawing/section.tsx";
import { AnglesPanel } from "./panels/angles.tsx";
import { ComparePanel } from "./panels/compare.tsx";
import { rowsOf } from "./model/csv.ts";
import { ConePanel } from "./panels/cone.tsx";
import { DetailPanel } from "./panels/detail.tsx";
import { Downloads } from "./panels/downloads.tsx";
import { FieldsPanel, Room, Toolbar } from "./panels/editor.tsx";
import { FitPanel } from "./panels/fit.tsx";
import { FilesPanel } from "./panels/files.tsx";
import { ImagePanel } from "./panels/image.tsx";
import { Header } from "./panels/header.tsx";
import { LedgerPanel } from "./panels/ledger.tsx";
import { Problems } from "./panels/problems.tsx";
import { Readability } from "./panels/readability.tsx";
import { Source } from "./panels/source.tsx";
import { Aged, ContentContext, AgeMark, liveClass } from "./panels/aged.tsx";
import { SurfacePanel } from "./panels/surface.tsx";
import { Summary } from "./panels/summary.tsx";
import { Spoken } from "./panels/spoken.tsx";
import { StatesTable } from "./panels/table.tsx";
import { Notes } from "./panels/notes.tsx";
import { SweepPanel } from "./panels/sweep.tsx";
import { Tabs } from "./panels/tabs.tsx";
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
import { openTab } from "./state/tab.ts";

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

const TABS = [
  { id: "image", name: "Picture", body: () => <ImagePanel /> },
  { id: "states", name: "States", body: () => <OfResult><StatesTable /></OfResult> },
  { id: "angles", name: "Angles", body: () => <AnglesPanel /> },
  { id: "cone", name: "All directions", body: () => <ConePanel /> },
  { id: "detail", name: "Fine detail", body: () => <DetailPanel /> },
  { id: "energy", name: "Energy balance", body: () => <OfResult><LedgerPanel /></OfResult> },
  { id: "reading", name: "Readability", body: () => <Reading /> },
  { id: "walk", name: "Monte Carlo", body: () => <WalkPanel /> },
  { id: "surface", name: "Surface", body: () => <SurfacePanel /> },
  { id: "sweep", name: "Sweep", body: () => <SweepPanel /> },
  { id: "compare", name: "Compare", body: () => <ComparePanel /> },
  { id: "fit", name: "Fit", body: () => <FitPanel /> },
  { id: "files", name: "Files", body: () => <FilesPanel /> },
];

/** The first place of the result, at its top: the summary and the states. A picture of the page comes here. */
function First() {
  return (
    <div class={`first${liveClass()}`}>
      <div class="top">
        <Summary />
        <span class="seen-from">
          <AgeMark age={liveAge.value} count={resultCount.value} more={firstError.value} />
          <Views />
        </span>
      </div>
      <Patches />
    </div>
  );
}

function ResultPanel() {
  return (
    <main
      id="result"
      tabindex={-1}
      class={`picture${busy.value ? " busy" : ""}${opening.value ? " opening" : ""}`}
      aria-busy={busy.value}
      aria-label="Result"
    >
      <First />
      <ContentContext.Provider value={{ age: liveAge.value }}>
        <div class={`plots${liveClass()}`}>
          <Chromaticity />
          <Spectra />
        </div>
      </ContentContext.Provider>
      <div class="details">
        <Tabs tabs={TABS} open={openTab} />
        <Notes />
      </div>
      <Spoken />
    </main>
  );
}

const PARTS: readonly (readonly [Part, string])[] = [
  ["design", "Design"],
  ["plots", "Diagrams"],
  ["details", "Tables and tools"],
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

export function App() {
  return (
    <>
      <Header />
      <Welcome />
      {answer.value && (
        <div class="bench" data-part={part.value}>
          <Design />
          <ResultPanel />
          {compact.value && <Sections />}
        </div>
      )}
      {!answer.value && (problems.value.length > 0 ? <Broken /> : <Starting />)}
    </>
  );
}
