// Lets one thing at a time move the body: a turn that begins ends the one before, and waits until that has left the body alone.

/** Whether no later turn has begun. */
export type GoesOn = () => boolean;

export class Turns {
  private last = 0;
  private queue: Promise<unknown> = Promise.resolve();
  private told?: () => void;

  /** `ended`: the present turn is to end. `busy`: whether a turn is under way. */
  constructor(
    private readonly ended: () => void,
    private readonly busy: (busy: boolean) => void,
  ) {}

  /** Carries out a turn after those before it. A turn that asks `goesOn` and hears no returns soon. */
  begin(turn: (goesOn: GoesOn) => Promise<void>): Promise<void> {
    this.end();
    const own = this.last;
    this.busy(true);
    const done = this.queue.then(() => turn(() => own === this.last));
    const left: Promise<void> = done.catch(() => undefined).then(() => this.busy(this.queue !== left));
    this.queue = left;
    return done;
  }

  /** Ends the present turn; no other begins. */
  end(): void {
    this.last++;
    this.told?.();
    this.told = undefined;
    this.ended();
  }

  /** Calls a function once, where the present turn is to end. */
  whenEnded(tell: () => void): void {
    this.told = tell;
  }
}
