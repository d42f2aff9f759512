// The stage: the display in a room. On it are the page of text and photograph; the handles of light and eye are above it.

import { useEffect, useRef } from "preact/hooks";
import { useSignalEffect } from "@preact/signals";

import { Room } from "../drawing/room.tsx";
import { degrees } from "../model/format.ts";
import { anglesOf } from "../model/perspective.ts";
import { compact, part } from "../state/compact.ts";
import { answer, text } from "../state/design.ts";
import { fileIds } from "../state/files.ts";
import {
  follow,
  holds,
  imageProblems,
  isTilting,
  lookFrom,
  MOST_ZOOM,
  movesEye,
  pictureName,
  reset,
  tilt,
  tilted,
  unfollow,
  whiteOfPage,
  zoom,
  zoomBy,
} from "../state/image.ts";
import { showTab } from "../state/tab.ts";
import { FileButton } from "./choose.tsx";
import { Display } from "./image-display.tsx";
import { Problems } from "./problems.tsx";

/** Requests the picture while it is visible. */
export function usePicture(): void {
  const me = useRef({}).current;
  useEffect(() => () => unfollow(me), []);
  useSignalEffect(() => {
    const isVisible = !compact.value || part.value === "details";
    // What determines the picture.
    void [text.value, fileIds.value, pictureName.value, tilt.value, holds.value, isTilting.value, answer.value];
    if (isVisible) follow(me);
    else unfollow(me);
  });
}

const EXPOSURES = {
  perfect: "a perfect white in this light",
  display: "the display's white",
  screen: "the brighter of a screen and a perfect white",
} as const;

/** Several views cannot follow the tilted display: it offers to replace them. */
function SeveralViews() {
  if (movesEye.value) return null;
  const { theta_deg } = anglesOf(tilt.value);
  return (
    <>
      {" "}
      The design has several views, which tilting does not move.{" "}
      {tilted.value && (
        <button type="button" class="key-link" onClick={() => lookFrom(tilt.value)}>
          Make {degrees(theta_deg)} its only view
        </button>
      )}
    </>
  );
}

export function Stage() {
  usePicture();
  return (
    <section class="stage seen" aria-label="Stage">
      <div class="scene">
        <Room />
        <Display />
      </div>
      <Problems of={imageProblems.value} />
      <div class="stage-tools">
        <p class="remark">
          Drag the display to tilt it: the eye follows. Exposure: the eye is adapted, white is {EXPOSURES[whiteOfPage.value]}; hues
          are kept.
          <SeveralViews />
        </p>
        <span role="group" aria-label="Zoom" class="zoom">
          <button type="button" aria-label="Smaller" onClick={() => zoomBy(1 / 1.5)} disabled={zoom.value <= 1}>
            −
          </button>
          <button type="button" aria-label="Larger" onClick={() => zoomBy(1.5)} disabled={zoom.value >= MOST_ZOOM}>
            +
          </button>
          <button type="button" onClick={reset} title="The whole display, in the direction of the design">
            Reset
          </button>
        </span>
        <FileButton label="Choose a picture" title="PNG or JPEG; or drop it on the page" stays />
        <button type="button" onClick={() => showTab("image")} title="Halftone, white, screen and paper beside it, files">
          More about the picture
        </button>
      </div>
    </section>
  );
}
