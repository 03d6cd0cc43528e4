(* Expressions: tokens, grammar, trees, conditions. Section 2 of docs/certificates.md. *)

open Text

type tree =
  | Num of Q.t
  | Pi
  | Sym of string
  | Sum of tree list
  | Prod of tree list
  | Pow of tree * tree
  | Fun of string * tree list

let zero = Num Q.zero
let one = Num Q.one
let number n = Num (Q.of_int n)
let negate = function Num q -> Num (Q.neg q) | a -> Prod [ Num Q.minus_one; a ]
let subtract a b = Sum [ a; negate b ]
let apply name a = Fun (name, [ a ])
let half_pi = Prod [ Pi; Num (Q.of_ints 1 2) ]
let equal (a : tree) (b : tree) = compare a b = 0

(* Tokens *)

type token = Number of Q.t | Name of string | Mark of string | End

let longest = 400_000
let deepest_tree = 2000

let read_number s i =
  let n = String.length s in
  let rec digits j = if j < n && is_digit s.[j] then digits (j + 1) else j in
  let j = digits i in
  let k = if j + 1 < n && s.[j] = '.' && is_digit s.[j + 1] then digits (j + 1) else j in
  if k - i > most_digits then refuse "a number of more than %d digits" most_digits;
  let whole = String.sub s i (j - i) in
  (Number (if k = j then Q.of_bigint (Z.of_string whole) else decimal whole (String.sub s (j + 1) (k - j - 1))), k)

let read_tokens s =
  let n = String.length s in
  let rec name j = if j < n && (is_letter s.[j] || is_digit s.[j] || s.[j] = '_') then name (j + 1) else j in
  let rec go i done_ =
    if i >= n then List.rev (End :: done_)
    else
      match s.[i] with
      | ' ' -> go (i + 1) done_
      | '*' when i + 1 < n && s.[i + 1] = '*' -> go (i + 2) (Mark "**" :: done_)
      | ('+' | '-' | '*' | '/' | '(' | ')' | ',') as c -> go (i + 1) (Mark (String.make 1 c) :: done_)
      | c when is_digit c -> let t, j = read_number s i in go j (t :: done_)
      | c when is_letter c -> let j = name i in go j (Name (String.sub s i (j - i)) :: done_)
      | c -> refuse "expression: unexpected character %C" c
  in
  go 0 []

(* Functions *)

let of_one =
  [ "exp"; "sin"; "cos"; "atan"; "sinh"; "cosh"; "tanh"; "log"; "sqrt"; "abs"; "asin"; "acos"; "tan"; "sec"; "cot"; "csc"; "erf" ]

(* exp_k, sin_k, cos_k: the name before the mark and k. A leading 0 is not accepted. *)
let tail_order name =
  let n = String.length name in
  if (n = 5 || n = 6) && name.[3] = '_' && List.mem (String.sub name 0 3) [ "exp"; "sin"; "cos" ] then
    let k = String.sub name 4 (n - 4) in
    if String.for_all is_digit k && (n = 5 || k.[0] <> '0') then Some (String.sub name 0 3, int_of_string k) else None
  else None

let arguments_of name =
  if name = "atan2" then 2
  else if List.mem name of_one || tail_order name <> None then 1
  else refuse "expression: unknown function %s" name

(* Grammar *)

type reader = { mutable rest : token list; mutable depth : int }

let next r = match r.rest with [] -> End | t :: _ -> t
let drop r = match r.rest with [] -> () | _ :: l -> r.rest <- l
let take r mark = if next r = Mark mark then drop r else refuse "expression: expected %s" mark

let deeper r f =
  r.depth <- r.depth + 1;
  if r.depth > deepest_tree then refuse "expression: deeper than %d levels" deepest_tree;
  let t = f r in
  r.depth <- r.depth - 1;
  t

let gather make = function [ a ] -> a | parts -> make (List.rev parts)

(* What is made of the parts of a text *)
type 'a grammar = {
  sum : 'a list -> 'a;
  negated : 'a -> 'a;
  product : 'a list -> 'a;
  below : 'a -> 'a; (* 1/x *)
  applied : 'a -> 'a -> 'a; (* a @ b *)
  power : 'a -> 'a -> 'a;
  entry : reader -> 'a;
}

let rec read_sum g r =
  let rec go parts =
    match next r with
    | Mark "+" -> drop r; let t = read_product g r in go (t :: parts)
    | Mark "-" -> drop r; let t = read_product g r in go (g.negated t :: parts)
    | _ -> gather g.sum parts
  in
  go [ read_product g r ]

and read_product g r =
  let rec go parts =
    match next r with
    | Mark "*" -> drop r; let t = read_signed g r in go (t :: parts)
    | Mark "/" -> drop r; let t = read_signed g r in go (g.below t :: parts)
    | Mark "@" ->
        drop r;
        let left = gather g.product parts in
        let right = read_signed g r in
        go [ g.applied left right ]
    | _ -> gather g.product parts
  in
  go [ read_signed g r ]

and read_signed g r =
  match next r with
  | Mark "+" -> drop r; deeper r (read_signed g)
  | Mark "-" -> drop r; g.negated (deeper r (read_signed g))
  | _ ->
      let base = g.entry r in
      if next r = Mark "**" then (drop r; let e = deeper r (read_signed g) in g.power base e) else base

let read_arguments g r =
  let rec go done_ =
    let done_ = deeper r (read_sum g) :: done_ in
    if next r = Mark "," then (drop r; go done_) else (take r ")"; List.rev done_)
  in
  go []

let read_inside g r =
  let t = deeper r (read_sum g) in
  take r ")"; t

let rec grammar () =
  {
    sum = (fun l -> Sum l);
    negated = negate;
    product = (fun l -> Prod l);
    below = (fun t -> Pow (t, Num Q.minus_one));
    applied = (fun _ _ -> refuse "expression: unexpected @");
    power = (fun a b -> Pow (a, b));
    entry = read_atom;
  }

and read_atom r =
  match next r with
  | Number q -> drop r; Num q
  | Mark "(" -> drop r; read_inside (grammar ()) r
  | Name f -> (
      drop r;
      match next r with
      | Mark "(" -> drop r; let args = read_arguments (grammar ()) r in
          if List.length args <> arguments_of f then refuse "expression: %s with %d arguments" f (List.length args);
          Fun (f, args)
      | _ -> if f = "pi" then Pi else Sym f)
  | _ -> refuse "expression: expected a number, a name or a parenthesis"

let read_tree s =
  if s = "" || String.length s > longest then refuse "expression: expected 1 to %d characters" longest;
  let r = { rest = read_tokens s; depth = 0 } in
  let t = read_sum (grammar ()) r in
  if next r <> End then refuse "expression: expected an operator";
  t

let get_tree what value = read_tree (get_text what value)

(* Parts *)

module Names = Set.Make (String)

let parts = function
  | Num _ | Pi | Sym _ -> []
  | Sum l | Prod l | Fun (_, l) -> l
  | Pow (a, b) -> [ a; b ]

let rec symbols_in found = function Sym s -> Names.add s found | t -> List.fold_left symbols_in found (parts t)
let symbols t = symbols_in Names.empty t
let rec has_symbols = function Sym _ -> true | t -> List.exists has_symbols (parts t)

(* The tree with [change part] in the place of every part where that is something. *)
let rec replace change t =
  match change t with
  | Some new_part -> new_part
  | None -> (
      let go = replace change in
      match t with
      | Num _ | Pi | Sym _ -> t
      | Sum l -> Sum (List.map go l)
      | Prod l -> Prod (List.map go l)
      | Fun (f, l) -> Fun (f, List.map go l)
      | Pow (a, b) -> Pow (go a, go b))

let put values = replace (function Sym s -> List.assoc_opt s values | _ -> None)
let rec terms = function Sum l -> List.concat_map terms l | t -> [ t ]
let rec factors = function Prod l -> List.concat_map factors l | t -> [ t ]

(* The rational constant of an exponent, or nothing. The normal form decides it, and algebra.ml sets it. *)
let constant : (tree -> Q.t option) ref = ref (fun _ -> None)

let is_whole q = Z.equal q.Q.den Z.one
let is_even q = is_whole q && Z.is_even q.Q.num

(* Conditions *)

type relation = Equal | Unequal | AtLeast | Above

let holds relation q =
  match relation with
  | Equal -> Q.sign q = 0
  | Unequal -> Q.sign q <> 0
  | AtLeast -> Q.sign q >= 0
  | Above -> Q.sign q > 0

let conditions_of_power level base exponent =
  match !constant exponent with
  | None -> [ (Above, base) ]
  | Some q when not (is_whole q) -> [ ((if Q.sign q < 0 || level = 2 then Above else AtLeast), base) ]
  | Some q -> if Q.sign q <= 0 then [ (Unequal, base) ] else []

let conditions_of_function level name args =
  let strict = if level = 2 then Above else AtLeast in
  match (name, args) with
  | "log", [ x ] -> [ (Above, x) ]
  | "sqrt", [ x ] -> [ (strict, x) ]
  | ("asin" | "acos"), [ x ] -> [ (strict, subtract one x); (strict, Sum [ one; x ]) ]
  | ("tan" | "sec"), [ x ] -> [ (Unequal, apply "cos" x) ]
  | ("cot" | "csc"), [ x ] -> [ (Unequal, apply "sin" x) ]
  | "abs", [ x ] -> if level = 2 then [ (Unequal, x) ] else []
  | "atan2", [ y; x ] ->
      let s = Sum [ Prod [ x; x ]; Prod [ y; y ] ] in
      (Unequal, s) :: (if level >= 1 then [ (Above, Sum [ x; apply "sqrt" s ]) ] else [])
  | _ -> []

(* The conditions of all these trees, in order, without repetition. *)
let conditions level trees =
  let rec go found t =
    let found = List.fold_left go found (parts t) in
    let own =
      match t with Pow (a, b) -> conditions_of_power level a b | Fun (f, l) -> conditions_of_function level f l | _ -> []
    in
    let add found (r, t) =
      match t with Num q when holds r q -> found | _ -> if List.mem (r, t) found then found else (r, t) :: found
    in
    List.fold_left add found own
  in
  List.rev (List.fold_left go [] trees)
