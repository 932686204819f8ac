export { Isophote } from "./isophote.js";
export { LookError, Planner } from "./planner.js";
export { looks } from "./looks.js";
