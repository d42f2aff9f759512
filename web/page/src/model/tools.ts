// The six steps of the page, their tools, and the command of the program that does the same as each tool.

export interface Tool {
  readonly id: string;
  readonly name: string;
  /** The command of the program, without what is chosen in the tool; FILE is the scenario. Null for what the page alone does. */
  readonly command: string | null;
  /** The table of the scenario that describes it, if it has one. */
  readonly table?: string;
  /** Whether the tool shows its command itself, with its options. */
  readonly showsCommand?: true;
}

export interface Step {
  readonly id: string;
  readonly name: string;
  readonly about: string;
  readonly tools: readonly Tool[];
}

export const STEPS: readonly Step[] = [
  {
    id: "start",
    name: "Start",
    about: "Open an example, a new display or a file",
    tools: [
      { id: "examples", name: "Examples", command: null },
      { id: "new", name: "New display", command: "papilio new" },
      { id: "files", name: "Files", command: "papilio diffuser inspect MEASURED.bsdf" },
      { id: "diffuser", name: "Measured diffuser", command: "papilio diffuser fit MEASURED.bsdf", showsCommand: true },
    ],
  },
  {
    id: "design",
    name: "Design",
    about: "Change layers, light and viewer, and see the result at once",
    tools: [
      { id: "stage", name: "Stage", command: "papilio run FILE" },
      { id: "side", name: "Side by side", command: null },
      { id: "states", name: "States", command: "papilio run FILE" },
      { id: "spectra", name: "Spectra", command: "papilio run FILE" },
      { id: "chromaticity", name: "Chromaticity", command: "papilio run FILE" },
      { id: "energy", name: "Energy balance", command: "papilio run FILE" },
      { id: "surface", name: "Surface", command: "papilio gonio" },
    ],
  },
  {
    id: "see",
    name: "See",
    about: "Look at it: pictures, rooms, angles, pixels, reading",
    tools: [
      { id: "image", name: "Picture", command: "papilio image FILE", table: "image" },
      { id: "rooms", name: "Rooms", command: "papilio image FILE" },
      {
        id: "angles",
        name: "Angles",
        command: "papilio run FILE --set 'viewer.theta_deg={from=-80,to=80,step=2}'",
      },
      { id: "cone", name: "All directions", command: "papilio run FILE --cone" },
      { id: "detail", name: "Fine detail", command: "papilio mtf FILE", table: "display.matrix" },
      { id: "reading", name: "Readability", command: "papilio run FILE" },
      { id: "pixel", name: "Pixel", command: "papilio pixel FILE" },
    ],
  },
  {
    id: "check",
    name: "Check",
    about: "Check it: by the other solver, against measurements",
    tools: [
      { id: "walk", name: "Monte Carlo", command: "papilio run FILE --solver monte-carlo" },
      { id: "compare", name: "Compare", command: "papilio compare FILE" },
      { id: "validate", name: "Published samples", command: "papilio validate --measured" },
      { id: "study", name: "Numerical study", command: "papilio study sampling FILE", showsCommand: true },
    ],
  },
  {
    id: "improve",
    name: "Improve",
    about: "Improve it: sweeps, searches, tolerances, fits",
    tools: [
      { id: "sweep", name: "Sweep", command: "papilio sweep FILE", table: "sweep" },
      { id: "optimize", name: "Optimise", command: "papilio optimize FILE", table: "optimize" },
      { id: "tolerance", name: "Tolerance", command: "papilio tolerance FILE", table: "tolerance" },
      { id: "fit", name: "Fit", command: "papilio fit FILE", table: "fit" },
      { id: "jobs", name: "Jobs", command: null },
    ],
  },
  {
    id: "share",
    name: "Share",
    about: "Share it: report, files, link, commands",
    tools: [
      { id: "export", name: "Report and files", command: "papilio run FILE --cone --report" },
      { id: "brdf", name: "BRDF", command: "papilio brdf FILE", showsCommand: true },
      { id: "commands", name: "Commands", command: null },
    ],
  },
];

export const TOOLS: readonly Tool[] = STEPS.flatMap(({ tools }) => tools);

/** Returns the step of a tool. */
export const stepOf = (tool: string): Step => STEPS.find(({ tools }) => tools.some(({ id }) => id === tool)) ?? STEPS[1]!;

export const toolOf = (id: string): Tool => TOOLS.find((tool) => tool.id === id) ?? STEPS[1]!.tools[0]!;

/** Returns a command for a scenario file of this name. */
export const commandFor = (command: string, file: string): string => command.replace(/\bFILE\b/, () => argument(file));

/** Returns an argument of a command as a shell reads it: in quotes, if it needs them. */
export const argument = (text: string): string => (/^[\w./,=:+-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
