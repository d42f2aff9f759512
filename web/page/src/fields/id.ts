/** Returns the id of the control of a key, without blanks, which separate ids in the attributes that name several. */
export const idOf = (path: string): string => `f-${path.replace(/\s/g, "_")}`;
