// Drive states: how each sub-pixel is driven in the selected state. If a default state is changed, it is written to
// the scenario.

import { useSignal } from "@preact/signals";

import { Choice } from "../fields/choice.tsx";
import { NumberField } from "../fields/number.tsx";
import { drives, isDefaultState, subPixels, type Drive } from "../model/drive.ts";
import { at, join, numberAt, textAt } from "../model/json.ts";
import { fields, showState, shownState, states } from "../state/design.ts";
import { edit, set } from "../state/live.ts";

function drive(state: string, sub: string, to: Drive): void {
  const own = Object.fromEntries(
    [...drives(fields.value, state)].map(([name, value]) => [name, name === sub ? to : value]),
  );
  const named = Object.fromEntries(Object.entries(own).filter(([, value]) => value !== 0));
  set(join("display.pixel.states", state), named);
}

function SubPixel({ state, sub, value }: { state: string; sub: string; value: Drive }) {
  const analogue = typeof value !== "number";
  const own = numberAt(fields.value, join("display.pixel.gap_nm", sub)) ?? 100;
  const id = `f-state-${sub}`;
  return (
    <div class="field">
      <label for={id}>{sub}</label>
      <div class="pair">
        <Choice
          label={`${sub}: driven by`}
          value={analogue ? "gap" : "area fraction"}
          options={["area fraction", "gap"]}
          change={(as) => drive(state, sub, as === "gap" ? { gap_nm: own } : 1)}
        />
        <NumberField
          id={id}
          name={sub}
          of={analogue ? "gap_nm" : ""}
          unit={analogue ? "nm" : ""}
          value={analogue ? value.gap_nm : value}
          limits={analogue ? { min: 0, max: 1e6 } : { min: 0, max: 1 }}
          invalid={false}
          describedBy="f-state-help"
          change={(to) => drive(state, sub, analogue ? { gap_nm: to } : to)}
        />
      </div>
    </div>
  );
}

function NewState() {
  const name = useSignal("");
  const add = (event: Event) => {
    event.preventDefault();
    const called = name.value.trim();
    const first = subPixels(fields.value)[0];
    if (!called || !first) return;
    edit([{ op: "set", path: join("display.pixel.states", called), value: { [first]: 0.5 } }]);
    showState(called);
    name.value = "";
  };
  return (
    <form class="inline-form" onSubmit={add}>
      <label for="f-new-state">New state</label>
      <input
        id="f-new-state"
        value={name.value}
        maxLength={64}
        onInput={(event) => (name.value = event.currentTarget.value)}
        placeholder="orange"
      />
      <button type="submit">Add</button>
    </form>
  );
}

export function StatesEditor() {
  const state = shownState.value;
  if (textAt(fields.value, "display.pixel.model") !== "film")
    return (
      <p class="help">
        Only the states of a film pixel can be edited here. Those of a table or of a uniform pixel are part of its data.
      </p>
    );
  const own = at(fields.value, join("display.pixel.states", state)) !== undefined;
  return (
    <>
      <div class="field">
        <label for="f-state">State</label>
        <Choice
          id="f-state"
          value={state}
          options={states.value.map(([name]) => name)}
          change={(name) => showState(name)}
        />
        <p class="help" id="f-state-help">
          Fraction of each sub-pixel's area that shows its own colour (the rest is dark), or an analogue gap.{" "}
          {isDefaultState(fields.value, state) && "This is a default state; a change writes it to the scenario."}
        </p>
      </div>
      {[...drives(fields.value, state)].map(([sub, value]) => (
        <SubPixel key={sub} state={state} sub={sub} value={value} />
      ))}
      {own && (
        <button
          type="button"
          onClick={() => {
            edit([{ op: "remove", path: join("display.pixel.states", state) }]);
          }}
        >
          Remove this state
        </button>
      )}
      <NewState />
    </>
  );
}
