// What the server takes and answers (interim, until its OpenAPI description is there).
export type Edit =
  | { op: "set"; path: string; value: unknown }
  | { op: "remove"; path: string }
  | { op: "insert"; path: string; index?: number; value: unknown }
  | { op: "move"; path: string; from: number; to: number };
export interface Problem { message: string; path?: string | null; line?: number | null; column?: number | null; expected?: string | null; hint?: string | null }
export type Num = number | null;
export interface Values {
  X: number; Y: number; Z: number; x: Num; y: Num; u_prime: Num; v_prime: Num; L_star: Num; a_star: Num; b_star: Num;
  luminance_cd_m2: number; contrast: Num; peak_nm: Num; distance_from_white_uv: Num; distance_from_d65_uv: Num;
  hue_rgb?: number[] | null; R_hemi?: Num; R_dir?: number[]; reflectance_factor: number[] | null; radiance: number[];
  terms: { diffuse: number; directed: number[]; environment?: number[]; front_light?: number; front_reflection: number };
  delta_E_2000_from_white?: Num;
}
export interface StateResult extends Values { standard_error: Values; discretisation_error?: Values }
export interface Share { returned: number; absorbed: Record<string, number>; unaccounted: number }
export interface Ledger extends Share { standard_error: Share; discretisation_error?: Share }
export type Metric =
  | "contrast_ratio" | "gamut_percent_srgb" | "gamut_percent_ebu" | "gamut_percent_ntsc" | "gamut_percent_dci_p3"
  | "coverage_percent_srgb" | "coverage_percent_ebu" | "average_peak_shift_nm" | "text_luminance_cd_m2" | "text_contrast"
  | "reading_surrogate_age_20" | "reading_surrogate_age_50" | "reading_surrogate_age_75" | "gamut_volume_cielab";
export type View = Record<Metric, Num> & {
  theta_deg: number; phi_deg: number; states: Record<string, StateResult>; ledger: Record<string, Ledger>;
  standard_error: Record<Metric, Num>; discretisation_error?: Record<Metric, Num>;
};
export interface Result {
  papilio: string; hash: string; seed: number; notes: string[]; warnings: string[]; wavelength_nm: number[];
  solver: { method: string; nodes?: number; paths?: number; degrees_of_freedom: number; relative_error_reached: number; interrupted: boolean };
  illuminant: { radiance_of_white: number[]; x: number; y: number; u_prime: number; v_prime: number };
  views: View[]; scenario: unknown;
}
export interface Live { scenario: string; fields: unknown; result: Result; warnings?: string[]; cost_ms?: number }
export interface Named { name: string; summary: string }
export interface Figure { name: string; svg: string }
export interface Upload { id: string; name: string; kind: string; words: string[]; figures: Figure[]; edits: { label: string; edits: Edit[] }[] }
export interface Angles { theta_deg: number[]; phi_deg: number; metrics: Record<string, Num[]>; states: Record<string, Record<string, Num[]>> }
export interface Cone { figures: Figure[] }
export interface Walked { value: number; standard_error: number; z: Num }
export interface WalkState { name: string; view: number; X: Walked; Y: Walked; Z: Walked }
export interface WalkProgress { paths: number; seconds: number; relative_error: number; states: WalkState[] }
export interface SweepPoint { index: number; of: number; values: Record<string, unknown>; metrics: Record<string, Num> }
export interface Start { name: string; scenario: string; files: Record<string, string> }
