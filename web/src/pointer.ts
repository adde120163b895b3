/** Whether it is fingers that point: they have neither a wheel nor keys to hold. */
export const byFinger = () => matchMedia("(pointer: coarse)").matches;
