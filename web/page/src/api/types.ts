// Names for the types of requests and responses. The types are generated from the server's OpenAPI description
// (`npm run types` generates openapi.d.ts from web/openapi.json).

import type { components } from "./openapi.d.ts";

type Schemas = components["schemas"];

export type Edit = Schemas["Edit"];
export type Problem = Schemas["OneError"];
export type Named = Schemas["Listed"];
export type Start = Schemas["Start"];
export type Figure = Schemas["Figure"];
export type Live = Schemas["Seen"];
export type Result = Schemas["ResultFile"];
export type View = Schemas["View"];
export type StateResult = Schemas["State"];
export type Values = Schemas["StateValues"];
export type Ledger = Schemas["Ledger"];
export type Angles = Schemas["AnglesSeen"];
export type Cone = Schemas["ConeSeen"];
export type WalkState = Schemas["WalkState"];
export type WalkProgress = Schemas["WalkProgress"];
export type Upload = Schemas["Kept"];
export type SweepPoint = Schemas["Point"];
export type SweepDone = Schemas["SweepDone"];
export type FitDone = Schemas["FitDone"];
export type FitProgress = Schemas["FitProgress"];
export type Compared = Schemas["Compared"];
export type Gonio = Schemas["Gonio"];
export type GonioProgress = Schemas["GonioProgress"];
export type SurfaceLayer = Schemas["SurfaceLayer"];
export type Detailed = Schemas["Detailed"];
export type PictureHead = Schemas["PictureHead"];
export type Label = Schemas["Label"];
export type MetricEntry = Schemas["MetricEntry"];
export type Lobe = Schemas["TransmittedLobe"];

export type MaterialEntry = Schemas["MaterialEntry"];
export type MaterialSheet = Schemas["MaterialSheet"];
export type IlluminantEntry = Schemas["IlluminantEntry"];
export type IlluminantSheet = Schemas["IlluminantSheet"];

/** A number that may be undefined. */
export type Num = number | null | undefined;

export type OptimizeDone = Schemas["OptimizeDone"];
export type OptimizeProgress = Schemas["OptimizeProgress"];
export type FoundDesign = Schemas["FoundDesign"];
export type ToleranceDone = Schemas["ToleranceDone"];
export type ToleranceProgress = Schemas["ToleranceProgress"];
export type PixelScanned = Schemas["PixelScanned"];
export type SampleEntry = Schemas["SampleEntry"];
export type Prediction = Schemas["Prediction"];
export type ValidateDone = Schemas["ValidateDone"];
export type ValidateProgress = Schemas["ValidateProgress"];
export type DataEntry = Schemas["DataEntry"];
export type Job = Schemas["JobSeen"];
export type JobList = Schemas["JobList"];
export type JobCommand = Schemas["JobCommand"];
export type CommandOption = Schemas["CommandOption"];
export type New = Schemas["NewDisplay"];
